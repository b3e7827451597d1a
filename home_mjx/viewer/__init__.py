"""Images, films and reports of episodes, and the demo."""
