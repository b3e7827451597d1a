"""The fused physics step on CPUs: Numba kernels that step one environment after another."""
