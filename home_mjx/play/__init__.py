"""Episodes of a task to look at: played by an expert, a trained agent, chance or a person, and filmed."""

from home_mjx.play.episode import Outcome
from home_mjx.play.run import PlayOptions, film_checkpoint, run_play

__all__ = ["Outcome", "PlayOptions", "film_checkpoint", "run_play"]
