"""Objects of a house: placement, mass, and doors split into frame and leaves."""
