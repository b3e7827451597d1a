"""Tasks as rows of arrays: descriptors, conditions and transitions; one compiled program steps any mix of them."""
