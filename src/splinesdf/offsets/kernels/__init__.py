"""Compiled loops that trim parallels and fit conics to what is left."""
