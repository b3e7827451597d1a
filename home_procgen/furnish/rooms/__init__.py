"""What goes into each type of room, and in which order."""
