"""Film of the demo: a trained agent finds a radio by sound and sight, in held-out houses."""

import dataclasses
from pathlib import Path

from home_mjx.viewer.episodes import EpisodeResult, PlayOptions, run_play

AGENT_FILE = Path(__file__).with_name("agent.npz")  # for its training see docs/training_results.md, "Packaged agent"
RADIO_OPTIONS = {"clip_split": "radio"}


def film_search(out: Path, suncg: str | Path | None = None, episodes: int = 1, seed: int = 0) -> list[EpisodeResult]:
    """Film the packaged agent while it searches for a radio; print nothing, return the result of each episode.

    Args:
        out: Folder for `radio.mp4`, with binaural sound, `radio.png` and `radio.jsonl`; created if missing.
        suncg: Root of a dataset, or its name, of which any houses are used; None: generated houses of the `val` split.
        episodes: Number of episodes, each in another house if there are enough.
        seed: Seed of episodes and actions.

    Raises:
        ConfigError: The extra `train` is not installed.
    """
    from home_mjx.training import read_config  # needs the extra `train`

    trained = read_config(AGENT_FILE).env
    env = dataclasses.replace(
        trained,
        options={**trained.options, **RADIO_OPTIONS},
        houses=None if suncg is None else str(suncg),
        num_houses=episodes,
        split="val" if suncg is None else None,
    )
    options = PlayOptions(env, "trained", AGENT_FILE, episodes, seed, out=out, name="radio")
    return run_play(options, lambda line: None)
