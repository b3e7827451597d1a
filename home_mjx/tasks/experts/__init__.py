"""Experts: what an agent that knows the house would do, inside `jit`, at every state."""
