"""Room acoustic parameters of ISO 3382-1, as functions for use inside `jit`."""
