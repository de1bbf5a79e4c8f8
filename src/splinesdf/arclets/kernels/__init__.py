"""Compiled loops over arclets: closest points, culling, winding numbers, crossings."""
