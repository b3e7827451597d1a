"""Define an observer: the distance to the goal over each episode, as a line of text and in a file beside the film."""

import dataclasses
import json
from pathlib import Path

from home_mjx import Observer, register_observer, use_compile_cache
from home_mjx.registry import find_spec
from home_mjx.viewer.episodes import PlayOptions, run_play

BLOCKS = "▁▂▃▄▅▆▇█"


class Approach(Observer):
    """Distances to the goal [m] at each step, per episode; `home-mjx play … --observe approach` uses it as well."""

    def __init__(self) -> None:
        self.episodes: list[list[float]] = []

    def on_episode_start(self, start) -> None:
        """Begin a list."""
        self.episodes.append([])

    def on_episode_step(self, step) -> None:
        """Read the task's metric; this is all that is copied from the device."""
        self.episodes[-1].append(float(step.state.metrics["distance"]))

    def on_episode_end(self, result) -> None:
        """Print the distances as bars."""
        distances = self.episodes[-1]
        top = max(distances) or 1.0
        print("".join(BLOCKS[int(x / top * (len(BLOCKS) - 1))] for x in distances), f"from {distances[0]:.1f} m")

    def write(self, folder: Path) -> None:
        """Write a file; it appears together with the film, or neither does."""
        (folder / "approach.json").write_text(json.dumps(self.episodes))


register_observer("approach", Approach)
if __name__ == "__main__":
    use_compile_cache()
    options = {"sensors": ("state",), "impl": "kinematic", "ctrl_dt": 0.3}
    spec = dataclasses.replace(find_spec("PointNav-v0"), options=options, num_houses=2)
    run_play(PlayOptions(spec, agent="expert", episodes=2), observers=["approach"])
