"""Kitchen and washing machines."""
