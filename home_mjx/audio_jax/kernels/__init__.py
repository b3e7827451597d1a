"""Kernels of an audio frame with moving sources: early paths, and late responses with tails; by XLA, Numba and CUDA."""
