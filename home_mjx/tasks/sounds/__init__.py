"""What sounds in an episode: as rows of tasks say it, and where and when it does."""
