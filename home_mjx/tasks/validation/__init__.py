"""What rows of a task bank may hold, whether they come from a file or as arrays."""
