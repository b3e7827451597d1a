"""Moving frames on NVIDIA GPUs: CUDA C kernels, compiled for the GPU at run time and called by XLA."""
