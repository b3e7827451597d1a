"""Moving frames on CPUs: loops of vectors, compiled by Numba and called by XLA."""
