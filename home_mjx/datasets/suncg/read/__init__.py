"""Reader of a house's files."""
