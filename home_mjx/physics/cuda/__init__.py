"""The fused step on NVIDIA GPUs: CUDA C, compiled at run time for the installed GPU and called by XLA."""
