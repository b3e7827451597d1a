"""Late sound of a bank, read in a step: between any two points, with doors as they stand."""
