"""Compiled loops that enclose the error of a spline."""
