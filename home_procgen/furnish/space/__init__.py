"""The space of a room: what stands where, and where more can stand, hang or lie."""
