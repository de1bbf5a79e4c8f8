"""Trimmed offsets: segments of parallel curves, joined to loops, as few conic arcs."""
