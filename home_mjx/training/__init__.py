"""Training on the environments; `shim` mends brax 0.14.2 under JAX >= 0.10."""
