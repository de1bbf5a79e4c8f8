"""The explorer page: a spline and its exact offsets in a browser, as a file or from a local server."""
