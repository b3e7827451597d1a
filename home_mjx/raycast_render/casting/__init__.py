"""`cast`, `occluded` and `cast_multi_hit`: batching, partitioning, gradients."""
