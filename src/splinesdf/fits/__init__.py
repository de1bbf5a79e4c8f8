"""Fits within a tolerance: the adaptive loop, its trials, and the proof of their error."""
