"""The ways to cast rays: pure JAX, CUDA, native CPU code."""
