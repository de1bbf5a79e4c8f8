"""What every floor stands on: arrays, compilation, threads, files. Nothing of the field."""
