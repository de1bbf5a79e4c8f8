"""Closed curves: polynomial pieces, the shapes they bound, and where they come from."""
