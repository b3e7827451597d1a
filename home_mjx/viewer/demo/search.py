"""Film of the demo: a trained agent finds sounds that it has never heard, by ear and eye, in held-out houses."""

import dataclasses
from pathlib import Path
from typing import Any

from home_mjx.audio_jax.auralization.clips import CLIPS
from home_mjx.registry import EnvSpec
from home_mjx.tasks.env.observers import EpisodeStep, Observer
from home_mjx.viewer.episodes import PlayOptions, run_play

AGENT_FILE = Path(__file__).with_name("agent.npz")  # for its training see docs/training_results.md, "Packaged agent"
SEARCH_OPTIONS = {"clip_split": "devices", "variation": None}


class ClipNames(Observer):
    """Names of the clips of the first source, of each episode in order."""

    def __init__(self) -> None:
        self.names: list[str] = []

    def on_episode_step(self, step: EpisodeStep) -> None:
        """Append the clip's name at the reset."""
        if step.index == 0:
            self.names.append(CLIPS[int(step.state.world.sounds.clip[0])])


def search_spec(trained: EnvSpec, episodes: int, suncg: str | Path | None = None) -> EnvSpec:
    """Return the spec of the search: that of the agent's training, with sounds of `SEARCH_OPTIONS` in other houses.

    Sensors and sound options of training stay. Houses are as in `film_search`.
    """
    return dataclasses.replace(
        trained,
        options={**trained.options, **SEARCH_OPTIONS},
        houses=None if suncg is None else str(suncg),
        num_houses=episodes,
        split="val" if suncg is None else None,
    )


def film_search(out: Path, suncg: str | Path | None = None, episodes: int = 1, seed: int = 0) -> list[dict[str, Any]]:
    """Film the packaged agent while it searches for sounds; print nothing, return each result and the `clip`'s name.

    Args:
        out: Folder for `search.mp4`, with binaural sound, `search.png` and `search.jsonl`; created if missing.
        suncg: Root of a dataset, or its name, of which any houses are used; None: generated houses of the `val` split.
        episodes: Number of episodes, each in another house if there are enough.
        seed: Seed of episodes and actions.

    Raises:
        ConfigError: The extra `train` is not installed.
    """
    from home_mjx.training import read_config  # needs the extra `train`

    env, clips = search_spec(read_config(AGENT_FILE).env, episodes, suncg), ClipNames()
    options = PlayOptions(env, "trained", AGENT_FILE, episodes, seed, out=out, name="search")
    results = run_play(options, lambda line: None, observers=[clips])
    return [dataclasses.asdict(one) | {"clip": clip} for one, clip in zip(results, clips.names, strict=True)]
