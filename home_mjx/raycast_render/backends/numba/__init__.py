"""The CPU backend: loops compiled by Numba, called inside `jit`."""
