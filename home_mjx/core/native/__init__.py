"""Support for custom kernels on CPUs and NVIDIA GPUs: Numba intrinsics, XLA's FFI, NVRTC."""
