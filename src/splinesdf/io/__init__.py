"""Files in and out, by extension."""
