"""Numbers shared by all executors."""

MISS = 3e38  # t of a miss, a finite replacement of infinity
FAR_SLACK = 1 + 6e-7  # bound of the rounding error of a slab distance, as in Ize's paper (see `xla`)
TINY = 1e-20  # minimum magnitude of a direction component in a division
