"""Episodes of a task to look at: played by an expert, a trained agent, chance or a person, and filmed."""

from home_mjx.viewer.episodes.episode import Outcome
from home_mjx.viewer.episodes.run import PlayOptions, film_checkpoint, run_play

__all__ = ["Outcome", "PlayOptions", "film_checkpoint", "run_play"]
