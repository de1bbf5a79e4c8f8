"""Compiled loops on arrays. No kernel file imports another (see CONTRIBUTING)."""
