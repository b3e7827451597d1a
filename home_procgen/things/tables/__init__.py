"""Tables to eat, work, play and dress at."""
