"""Houses and models to SUNCG's files."""
