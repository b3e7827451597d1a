"""Shared parts of adapters: agents by name, jittable spaces, batches as functions of one environment."""
