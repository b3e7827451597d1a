"""Contact sounds of bodies: synthesised, held in a few slots, and emitted like other sources."""
