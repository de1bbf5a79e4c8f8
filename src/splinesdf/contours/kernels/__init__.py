"""Compiled loops over conic arcs: biarcs, and where contours meet."""
