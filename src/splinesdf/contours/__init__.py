"""Contours of conic arcs: what they are, biarcs in their place, and which lies in which."""
