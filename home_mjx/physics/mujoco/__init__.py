"""C MuJoCo, called inside `jit` on CPUs: one model per house, with everything that the house contains."""
