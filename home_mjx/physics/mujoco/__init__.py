"""C MuJoCo, called inside `jit` on the CPU: one model per house, with all that the house has."""
