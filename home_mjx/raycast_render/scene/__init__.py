"""The scene of one environment as rays see it."""
