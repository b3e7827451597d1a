"""Reader of Habitat's scene datasets, and of the scans that Habitat shows."""
