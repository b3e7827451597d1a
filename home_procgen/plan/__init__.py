"""Floor plans of homes: storeys of rooms along halls, doors that leave private rooms at the ends, windows, stairs."""
