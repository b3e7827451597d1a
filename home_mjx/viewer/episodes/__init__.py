"""Playing and filming episodes of a task with an expert, a trained agent, a random agent or a person."""

from home_mjx.tasks.env.observers import EpisodeResult
from home_mjx.viewer.episodes.run import PlayOptions, film_checkpoint, run_play

__all__ = ["EpisodeResult", "PlayOptions", "film_checkpoint", "run_play"]
