"""The `home-mjx story` command: its house, its script, and its film."""
