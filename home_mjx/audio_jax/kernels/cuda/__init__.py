"""Early sound of moving frames on NVIDIA GPUs: CUDA C, compiled for this GPU at run time and called by XLA."""
