"""Play and film episodes of a task: by an expert, a trained or a random agent, or by yourself with the keyboard."""

import argparse
import dataclasses
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from home_mjx.cli.houses import add_dataset_option
from home_mjx.cli.learning.arguments import (
    CHECKPOINT_HELP,
    TASK_HELP,
    add_episode_option,
    add_import_option,
    add_observe_option,
    add_sensors_option,
    add_viewer_option,
    find_checkpoint,
    import_modules,
    job_viewers,
    parse_checkpoint_path,
    task_spec,
)
from home_mjx.cli.output import make_folder
from home_mjx.cli.parsing import house_count_type, image_side_type, parse_path, parse_seed, positive_int_type
from home_mjx.core.jsonable import parse_assignments
from home_mjx.datasets.registry import has_scheme
from home_mjx.errors import ConfigError

if TYPE_CHECKING:
    from home_mjx.registry import EnvSpec
    from home_mjx.tasks.env.observers import Observer
    from home_mjx.viewer.episodes.observers import ShotCache

EXPERT, TRAINED = "expert", "trained"
BLIND_SENSORS = ("state",)  # sensors of agents that do not use observations


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the optional `TASK`, a text for `task_spec`, and the options of `home-mjx play`.

    `--agent` is `expert`, `random`, `trained` or `human`; None by default. `--checkpoint` is a path or `demo`.
    `--greedy`, `--no-film`, `--html` and `--replay` are flags, and `--out` is the path of a folder (`play`).
    `--viewer` and `--port` are as in `add_viewer_option`.

    `--episodes` (3), `--houses` (4) and `--samples` (1) are from 1. `--size W H` is in pixels (480 360). `--seed` is
    from 0 to 2**32 - 1 (0). `--split` is `train`, `val` or `test`; None by default.

    The repeatable `--env NAME=VALUE` is a list of texts. `--dataset` is as in `add_dataset_option`. `--episode-file`,
    `--import`, `--observe` and `--sensors` are as in `learning.arguments`.
    """
    parser.add_argument("task", nargs="?", metavar="TASK", help=f"{TASK_HELP} (default: the checkpoint's)")
    parser.add_argument(
        "--agent",
        choices=(EXPERT, "random", TRAINED, "human"),
        help="agent that plays (default: expert, or trained with --checkpoint)",
    )
    parser.add_argument("--checkpoint", type=parse_checkpoint_path, help=CHECKPOINT_HELP)
    parser.add_argument("--greedy", action="store_true", help="take a trained agent's most likely action")
    parser.add_argument("--episodes", type=positive_int_type, default=3, help="number of episodes (default: 3)")
    parser.add_argument("--out", type=parse_path, default=Path("play"), help="folder for the film (default: play)")
    parser.add_argument("--no-film", action="store_true", help="do not write a film")
    parser.add_argument("--html", action="store_true", help="also write the episodes as a 3D page without a server")
    parser.add_argument("--replay", action="store_true", help="also write all states, for `home-mjx view --replay`")
    parser.add_argument(
        "--size", type=image_side_type, nargs=2, default=(480, 360), metavar=("W", "H"),
        help="size of the agent's view [pixels] (default: 480 360)",
    )  # fmt: skip
    parser.add_argument("--samples", type=positive_int_type, default=1, help="rays per pixel (default: 1)")
    parser.add_argument("--seed", type=parse_seed, default=0, help="seed of episodes and actions (default: 0)")
    parser.add_argument("--houses", type=house_count_type, default=4, help="number of houses (default: 4)")
    parser.add_argument(
        "--split",
        choices=("train", "val", "test"),
        help="split of the dataset (default: val; all houses of a name such as procedural:4)",
    )
    add_episode_option(parser)
    add_dataset_option(parser)
    add_import_option(parser)
    add_viewer_option(parser)
    add_observe_option(parser, "`terminal`")
    add_sensors_option(
        parser,
        "observed sensors (default: those of the checkpoint, else state, and audio for films of tasks with sounds)",
    )
    parser.add_argument("--env", action="append", default=[], metavar="NAME=VALUE", help="an option of home_mjx.make")


def run(args: argparse.Namespace) -> int:
    """Play episodes, print a line per episode and the paths of film and image, if any, and return 0.

    The agent is by default `trained` with a checkpoint, else `expert`. The split is by default `val`, or all houses if
    `--dataset` is a name with a scheme.
    """
    from home_mjx.viewer.episodes.observers import ShotCache
    from home_mjx.viewer.episodes.policies import check_agent
    from home_mjx.viewer.episodes.run import AGENT_NAMES, PlayOptions, run_play

    import_modules(args.modules)
    args.split = args.split or (None if has_scheme(args.dataset) else "val")
    path = args.checkpoint and find_checkpoint(args.checkpoint)
    width, height = args.size
    options = PlayOptions(
        env=play_spec(args, path),
        agent=args.agent or (EXPERT if path is None else TRAINED),
        checkpoint=path,
        episodes=args.episodes,
        seed=args.seed,
        greedy=args.greedy,
        width=width,
        height=height,
        samples=args.samples,
    )
    check_agent(options.agent, path, AGENT_NAMES)
    if not args.no_film:
        options = dataclasses.replace(options, out=make_folder(args.out))
    shots = ShotCache(width, height, args.samples)
    recorders = _recorders(args, options.file_name, shots)
    run_play(options, observers=[*args.observers, *recorders, *job_viewers(args)], shots=shots)
    if options.out is not None:
        base = options.out / options.file_name
        sys.stdout.write(f"Watch   {base}.mp4\nLook at {base}.png\n" + f"Open    {base}.html\n" * args.html)
        sys.stdout.write(f"Replay  home-mjx view --replay {base}.replay.npz\n" * args.replay)
    return 0


def _recorders(args: argparse.Namespace, name: str, shots: "ShotCache") -> "list[Observer]":
    """Return the recorders for `--html` and `--replay`.

    Raises:
        ConfigError: The extra `view` is not installed for `--html`, or there is no folder because of `--no-film`.
    """
    for flag in ("html", "replay"):
        if getattr(args, flag) and args.no_film:
            hint = "The file is written beside the film."
            raise ConfigError(f"--{flag} cannot be combined with --no-film", hint=hint)
    return [*_page_recorders(args, name, shots), *_replay_recorders(args, name)]


def _page_recorders(args: argparse.Namespace, name: str, shots: "ShotCache") -> "list[Observer]":
    """Return the recorder of a page for `--html`, else none."""
    if not args.html:
        return []
    from home_mjx.viewer.replay.page import PageRecorder

    return [PageRecorder(name, shots)]


def _replay_recorders(args: argparse.Namespace, name: str) -> "list[Observer]":
    """Return the recorder of states for `--replay`, else none."""
    if not args.replay:
        return []
    from home_mjx.viewer.replay.recorder import ReplayRecorder

    return [ReplayRecorder(name)]


def play_spec(args: argparse.Namespace, checkpoint: Path | None) -> "EnvSpec":
    """Return the spec of `env_spec`, with few sensors by default.

    With `--sensors`, or a checkpoint, it has those sensors. Else it has `state`, and `audio` for films of tasks with
    sounds; sensors by `--env` stay. Agents without a checkpoint use no observations, so that the default computes as
    few as possible.
    """
    if args.sensors is not None or checkpoint is not None:
        return env_spec(args, checkpoint, args.sensors)
    spec = env_spec(args, None, BLIND_SENSORS)
    if args.no_film or spec.options["sensors"] != BLIND_SENSORS:
        return spec
    from home_mjx.viewer.episodes.run import default_sensors

    return dataclasses.replace(spec, options={**spec.options, "sensors": default_sensors(spec)})


def env_spec(args: argparse.Namespace, checkpoint: Path | None, sensors: tuple[str, ...] | None = None) -> "EnvSpec":
    """Return the spec of a checkpoint, else of the named task, with houses and options from the arguments.

    `sensors` replaces its sensors; None: unchanged. `--env` overrides both, and the option `episodes` is
    `--episode-file`, if given. Without `--dataset` its own houses stay; their number and split are always those of the
    arguments.

    Raises:
        ConfigError: There is neither a task nor a checkpoint, or the checkpoint is of another task. Or as of
            `task_spec`.
    """
    if args.task is None and checkpoint is None:
        raise ConfigError("expected a task", hint="For example home-mjx play RoomNav; home_mjx.list_envs() lists them.")
    spec = task_spec(args.task) if args.task is not None else None
    if checkpoint is not None:
        from home_mjx.training import evaluation_spec, read_config

        theirs = evaluation_spec(read_config(checkpoint).env)  # without training-only options
        if spec is not None and spec.id != theirs.id:
            message = f"expected a checkpoint of {spec.id}, got one of {theirs.id}"
            raise ConfigError(message, file=checkpoint, hint="Omit the task, or pass another checkpoint.")
        spec = theirs
    assert spec is not None
    houses = spec.houses if args.dataset is None else str(args.dataset)
    seen = {} if sensors is None else {"sensors": sensors}
    rows = {} if args.episode_file is None else {"episodes": str(args.episode_file)}
    options = {**spec.options, **seen, **parse_assignments(args.env), **rows}
    return dataclasses.replace(spec, options=options, houses=houses, num_houses=args.houses, split=args.split)
