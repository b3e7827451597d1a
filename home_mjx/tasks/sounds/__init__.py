"""Sounds of an episode: as declared in rows of tasks, and as sources over time."""
