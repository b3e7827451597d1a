"""`cast`, `occluded` and `cast_through`: batching, partitioning, gradients."""
