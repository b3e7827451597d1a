"""Floor plans of homes: storeys with rooms along halls, doors, windows and stairs."""
