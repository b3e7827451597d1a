"""Replay: episodes recorded state by state, shown again in the browser, and pages of episodes without a server."""
