"""Chairs, armchairs, sofas, stools and benches."""
