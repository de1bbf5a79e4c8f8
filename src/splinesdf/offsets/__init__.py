"""Trimmed offsets: what is left of the parallel curves, joined to loops, as few conic arcs."""
