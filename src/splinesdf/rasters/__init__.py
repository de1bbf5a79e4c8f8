"""The distance as pictures for graphics: one shape as a texture, many as an atlas."""
