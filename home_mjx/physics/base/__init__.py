"""What every implementation of the physics shares: options, state, and where numbers lie in it."""
