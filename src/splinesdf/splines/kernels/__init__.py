"""Compiled loops of the extension beside the domain."""
