"""Training on the environments: recurrent PPO in plain JAX; `shim` mends brax 0.14.2 under JAX >= 0.10."""
