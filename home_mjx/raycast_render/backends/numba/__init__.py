"""The CPU executor: loops compiled by Numba, called inside `jit`."""
