"""Moving frames on CPUs: SIMD loops compiled by Numba and called by XLA."""
