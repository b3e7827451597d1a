"""The fused physics step on CPUs: loops compiled by Numba, one environment after the other."""
