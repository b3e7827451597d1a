"""Words, phrases and tokens of tasks."""
