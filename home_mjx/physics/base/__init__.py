"""Options, state and array layout, common to all implementations of the physics."""
