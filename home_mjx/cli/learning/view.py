"""Open a task or a house in a web browser: 3D scene, the agent's view, sound and controls; you can drive the agent."""

import argparse
import dataclasses
from typing import TYPE_CHECKING

from home_mjx.cli.houses import add_dataset_option, is_dataset_root, open_selected_dataset, selected_houses
from home_mjx.cli.learning.arguments import (
    CHECKPOINT_HELP,
    MAX_PORT,
    add_episode_option,
    add_import_option,
    add_sensors_option,
    import_modules,
    newest_version,
    parse_checkpoint_path,
    print_now,
)
from home_mjx.cli.learning.play import BLIND_SENSORS, play_spec
from home_mjx.cli.parsing import house_count_type, image_side_type, parse_path, parse_seed, whole_number_type
from home_mjx.core.jsonable import parse_assignments
from home_mjx.datasets.registry import has_scheme
from home_mjx.errors import ConfigError
from home_mjx.registry import list_envs

if TYPE_CHECKING:
    from home_mjx.tasks.env.env import Env
    from home_mjx.tasks.env.household import HouseholdEnv
    from home_mjx.tasks.env.observers import Observer
    from home_mjx.viewer.browser.run import ViewOptions

HOUSE_TASK = "PointNav"  # task of a house without one: it adds nothing to see but a goal
MAX_ENVS = 64
CAMERAS = ("first", "third", "top", "free")  # in the order of `VIEWPOINTS`
HOUSE_OPTIONS = {"ctrl_dt": 0.05, "episode_length": 100_000}  # options of this task: smooth, and almost without an end


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the optional `TARGET`, a task or a house, and the options of `home-mjx view`.

    `--agent` is as in `home-mjx play`; None by default. `--checkpoint` is a path or `demo`, `--replay` a path or None,
    `--record` the path of a folder or None. `--gallery` and `--validate` are flags. `--host` is a text (localhost),
    `--port` from 1 (8080), `--size` in pixels (512), `--shader` a name (fast), `--camera` one of `CAMERAS` (first),
    `--seed` from 0 (0), `--num-envs` from 1 (1), `--houses` from 1 (4). `--split`, `--env`, `--dataset`,
    `--episode-file`, `--import` and `--sensors` are as in `home-mjx play`.
    """
    parser.add_argument(
        "target", nargs="?", metavar="TASK | HOUSE",
        help="id of an environment; or a house: an id of --dataset, or a name such as procedural:4?seed=40 (default: "
        "the houses of --dataset, or a generated one)",
    )  # fmt: skip
    parser.add_argument(
        "--agent", choices=("expert", "random", "trained", "human"),
        help="agent that acts (default: human, or trained with --checkpoint)",
    )  # fmt: skip
    parser.add_argument("--checkpoint", type=parse_checkpoint_path, help=CHECKPOINT_HELP)
    parser.add_argument(
        "--replay", type=parse_path, metavar="FILE",
        help="show recorded episodes: a file of `home-mjx play --replay`, or a folder of `home-mjx record`",
    )  # fmt: skip
    parser.add_argument("--host", default="localhost", help="name or address to serve at (default: localhost)")
    parser.add_argument(
        "--port", type=whole_number_type(MAX_PORT), default=8080, help="port, or the next free one (default: 8080)"
    )
    parser.add_argument("--size", type=image_side_type, default=512, help="size of the picture [pixels] (default: 512)")
    parser.add_argument("--shader", default="fast", help="shader of the picture: fast, lit or your own (default: fast)")
    parser.add_argument("--camera", choices=CAMERAS, default="first", help="camera of the picture (default: first)")
    parser.add_argument("--seed", type=parse_seed, default=0, help="seed of episodes and actions (default: 0)")
    parser.add_argument(
        "--num-envs", type=whole_number_type(MAX_ENVS), default=1,
        help="number of environments, of which a grid shows up to nine; click on one to watch it (default: 1)",
    )  # fmt: skip
    parser.add_argument(
        "--houses", type=house_count_type, default=4, help="number of houses of a task or a gallery (default: 4)"
    )
    parser.add_argument("--split", choices=("train", "val", "test"), help="split of the dataset (default: as of play)")
    parser.add_argument(
        "--gallery", action="store_true", help="show all houses side by side, without an agent, to look through them"
    )
    parser.add_argument(
        "--validate", action="store_true", help="with --gallery: mark the validator's findings where they are"
    )
    parser.add_argument(
        "--record", type=parse_path, metavar="FOLDER",
        help="record all episodes as a data set of trajectories, in a folder of it for each task and agent",
    )  # fmt: skip
    add_episode_option(parser)
    add_dataset_option(parser)
    add_import_option(parser)
    add_sensors_option(parser, "observed sensors (default: state, and audio in tasks with sounds)")
    parser.add_argument("--env", action="append", default=[], metavar="NAME=VALUE", help="an option of home_mjx.make")


def run(args: argparse.Namespace) -> int:
    """Serve the viewer until an interrupt, and print its address; return 0."""
    from home_mjx.viewer.browser.live_camera import PictureOptions
    from home_mjx.viewer.browser.run import ViewOptions, run_view
    from home_mjx.viewer.browser.serving.server import load_viser
    from home_mjx.viewer.episodes.viewpoints import VIEWPOINTS

    load_viser()
    import_modules(args.modules)
    options = ViewOptions(
        agent=args.agent or ("human" if args.checkpoint is None else "trained"),
        checkpoint=args.checkpoint,
        seed=args.seed,
        picture=PictureOptions(shader=args.shader, size=args.size, viewpoint=VIEWPOINTS[CAMERAS.index(args.camera)]),
        host=args.host,
        port=args.port,
        num_envs=args.num_envs,
        observers=_recorders(args),
    )
    if args.validate and not args.gallery:
        raise ConfigError("--validate marks findings in --gallery", hint="Add --gallery, or use home-mjx inspect.")
    if args.gallery:
        _check_gallery(args)
        _run_gallery(args, options)
    elif args.replay is not None:
        from home_mjx.viewer.replay.run import run_replay

        run_replay(args.replay, options, print_now)
    else:
        run_view(_make_env(args), options, print_now)
    return 0


def _recorders(args: argparse.Namespace) -> "tuple[Observer, ...]":
    """Return the recorder for `--record`, else none.

    Raises:
        ConfigError: There are several environments, or a replay or a gallery has nothing to record.
    """
    if args.record is None:
        return ()
    if args.num_envs > 1 or args.replay is not None or args.gallery:
        hint = "Leave out --num-envs, --replay and --gallery."
        raise ConfigError("--record records the episodes of one environment", hint=hint)
    from home_mjx.viewer.episodes.trajectory_observer import TrajectoryObserver

    return (TrajectoryObserver(args.record),)


def _check_gallery(args: argparse.Namespace) -> None:
    """Raise `ConfigError` for an option of episodes, which a gallery of houses does not have."""
    given = ("replay", "checkpoint", "agent", "env", "split")
    for name in filter(lambda name: getattr(args, name), given):
        hint = "Leave it out, or leave out --gallery."
        raise ConfigError(f"--gallery shows houses without agents, and has no use for --{name}", hint=hint)


def _run_gallery(args: argparse.Namespace, options: "ViewOptions") -> None:
    """Serve the houses of the target side by side, with `--validate` also their findings."""
    from home_mjx.bank.bank import HouseBank
    from home_mjx.bank.packing.texture_layers import texture_size_for
    from home_mjx.datasets import validate_house
    from home_mjx.viewer.gallery.findings import place_findings
    from home_mjx.viewer.gallery.viewer import run_gallery

    args.house = args.target
    dataset = open_selected_dataset(args)
    compiled, findings = dataclasses.replace(selected_houses(args), num_houses=args.houses).load(), {}
    for house in compiled if args.validate else ():
        found = validate_house(dataset, house.id)
        findings[house.id] = place_findings(dataset.load_house(house.id), found, house.offset)
    run_gallery(HouseBank.from_compiled(compiled, texture_size_for(args.size)), options, print_now, findings)


def _make_env(args: argparse.Namespace) -> "Env[HouseholdEnv]":
    """Make the environment of a task or a checkpoint, else that of a house, which has `HOUSE_TASK`.

    A target is a house if it is a name with a scheme or a path, or if no task has this name and there is a dataset.
    """
    from home_mjx.bank.packing.texture_layers import texture_size_for
    from home_mjx.env_factory import make
    from home_mjx.houses.load import load_bank
    from home_mjx.viewer.browser.checkpoints import Checkpoints

    if (args.target is None and args.checkpoint is not None) or _is_task(args):
        args.task, args.no_film = args.target, False
        args.split = args.split or (None if has_scheme(args.dataset) else "val")
        return make(play_spec(args, args.checkpoint and Checkpoints(args.checkpoint).load_path()))
    args.house = args.target
    sensors = {"sensors": args.sensors or BLIND_SENSORS}
    bank = load_bank(selected_houses(args), texture_size=texture_size_for(args.size))
    switches = {"switches": "initial"} if bank.switches.kind.shape[1] else {}  # so that clicks switch lamps
    options = {**HOUSE_OPTIONS, **switches, **sensors, **parse_assignments(args.env)}
    return make(newest_version(HOUSE_TASK), bank, **options)


def _is_task(args: argparse.Namespace) -> bool:
    """Return whether the target names a task, or nothing that could be a house."""
    if args.target is None or is_dataset_root(argparse.Namespace(house=args.target, dataset=args.dataset)):
        return False
    return args.dataset is None or newest_version(args.target) in list_envs()
