"""Expert policies with access to the house, computed inside `jit` for every state."""
