"""Cars, cycles and their wheels."""
