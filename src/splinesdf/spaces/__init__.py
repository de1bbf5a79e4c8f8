"""Spline spaces: elements (a family of B-splines), and a mesh with one (a space).

A spline is a mesh, an element and so many numbers a cell; see `element` and `space`.
"""
