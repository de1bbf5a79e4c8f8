"""The explorer page: a spline and exact offsets in a browser, as a file or by a local server."""
