"""Numbers that all executors share."""

MISS = 3e38  # finite stand-in for infinity
FAR_SLACK = 1 + 6e-7  # bound on the rounding of a slab distance, as in Ize's paper (see `xla`)
TINY = 1e-20  # smallest direction component that is divided by
