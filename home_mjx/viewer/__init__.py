"""Pictures, films, episodes and the demo: everything that shows a person what happens."""
