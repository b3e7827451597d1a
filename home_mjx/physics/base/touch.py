"""What a mobile can touch besides other mobiles, as numbers; a mobile's own is its index."""

NOTHING, FLOOR, STATIC = -1, -2, -3  # static box c is STATIC - c
