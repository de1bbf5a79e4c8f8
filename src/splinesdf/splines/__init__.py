"""The spline of a fit: evaluation, extension beside its domain, level sets, saved files."""
