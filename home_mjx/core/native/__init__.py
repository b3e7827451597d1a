"""What own kernels need on a CPU and on an NVIDIA GPU: pointers for Numba, XLA's interface, NVRTC."""
