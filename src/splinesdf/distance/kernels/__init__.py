"""Compiled loops on branches of the distance and their foot points."""
