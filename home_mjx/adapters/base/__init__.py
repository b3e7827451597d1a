"""What adapters share: agents by name, jittable spaces, batches as functions of one environment."""
