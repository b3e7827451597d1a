"""What `home-mjx demo --story` does: its house, its script, and the film of it."""
