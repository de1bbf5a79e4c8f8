"""Many shapes: one job for each, by processes on this machine or on a Dask cluster."""
