"""A house from its files."""
