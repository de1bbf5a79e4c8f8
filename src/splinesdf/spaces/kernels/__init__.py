"""Compiled loops from coefficients to ordinates, and from those to values."""
