"""`cast` and `occluded`: batching, partitioning, gradients."""
