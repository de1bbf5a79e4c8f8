"""The ground of every floor: arrays, compilation, threads, files. Nothing of the field."""
