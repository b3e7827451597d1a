"""The film of the demo: an agent that was trained finds a radio by ear and eye, in houses that it has never been in."""

import dataclasses
from pathlib import Path

from home_mjx.viewer.episodes import Outcome, PlayOptions, run_play

AGENT = Path(__file__).with_name("agent.npz")  # what trained it is said in docs/training.md, "The agent in the box"
RADIO = {"clip_split": "radio"}


def film_search(out: Path, suncg: Path | None = None, episodes: int = 3, seed: int = 0) -> list[Outcome]:
    """Films the agent that comes with the package.

    Args:
        out: Folder for `radio.mp4`, with what both ears hear, `radio.png` and `radio.jsonl`; it exists.
        suncg: Root of a SUNCG dataset, then any houses of it; None: generated houses of the `val` part.
        episodes: How many, each in another house as long as there are others.
        seed: Of episodes and actions.

    Returns:
        How each episode has ended.

    Raises:
        ConfigError: The extra `train` is not installed.

    Example:
        >>> film_search(Path("demo"))  # doctest: +SKIP
    """
    from home_mjx.training import read_config  # needs the extra `train`

    trained = read_config(AGENT).env
    env = dataclasses.replace(
        trained,
        options={**trained.options, **RADIO},
        houses=None if suncg is None else str(suncg),
        num_houses=episodes,
        split="val" if suncg is None else None,
    )
    options = PlayOptions(env, "trained", AGENT, episodes, seed, out=out)
    outcomes = run_play(options, lambda line: None)
    for path in out.glob(f"{options.name}.*"):
        path.rename(path.with_stem("radio"))
    return outcomes
