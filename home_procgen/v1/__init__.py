"""The first generator: flats on one floor, from parametric furniture and recursively split floor plans."""
