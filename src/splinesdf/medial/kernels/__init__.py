"""Compiled loops of the medial axis."""
