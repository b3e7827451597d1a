"""Backends of ray casts: pure JAX, CUDA and native CPU code."""
