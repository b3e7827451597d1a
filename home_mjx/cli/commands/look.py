"""Print a state of `save_states` or `dump_flagged`, and draw the agent's view beside the plan with goal and path."""

import argparse
import dataclasses
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from home_mjx.cli.learning.arguments import TASK_HELP, add_import_option, import_modules, task_spec
from home_mjx.cli.output import make_folder
from home_mjx.cli.parsing import house_count_type, image_side_type, parse_dataset, parse_natural, parse_path
from home_mjx.core.jsonable import parse_assignments
from home_mjx.core.progress import show_compile
from home_mjx.errors import ConfigError

if TYPE_CHECKING:
    from home_mjx.registry import EnvSpec
    from home_mjx.tasks.env.env import Env
    from home_mjx.tasks.env.state_io import StateOrigin


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add `STATES`, the path of a file of states, and the options of `home-mjx look`.

    `--env N` is an index from 0 (0). `--no-picture` is a flag, `--out` the path of a folder (`look`), `--size W H` in
    pixels (480 360). `--dataset` is a path or a text `scheme:...`, see `parse_dataset`; None: that of the file.
    `--import` is as in `add_import_option`.

    For files without their environment: `--task`, a text or None; the repeatable `--option NAME=VALUE`, a list of
    texts; and `--houses`, a number or None.
    """
    parser.add_argument(
        "states", type=parse_path, metavar="STATES", help="file of save_states or dump_flagged, written with its `env`"
    )
    parser.add_argument(
        "--env", type=parse_natural, default=0, metavar="N", help="number of the environment (default: 0)"
    )
    parser.add_argument("--no-picture", action="store_true", help="print only")
    parser.add_argument("--out", type=parse_path, default=Path("look"), help="folder for the picture (default: look)")
    parser.add_argument(
        "--size", type=image_side_type, nargs=2, default=(480, 360), metavar=("W", "H"),
        help="size of the agent's view [pixels] (default: 480 360)",
    )  # fmt: skip
    parser.add_argument(
        "--dataset",
        type=parse_dataset,
        metavar="ROOT",
        help="folder of the dataset of the houses, or its name (default: that of the file)",
    )
    add_import_option(parser)
    group = parser.add_argument_group("files that were written without their environment")
    group.add_argument("--task", metavar="TASK", help=TASK_HELP)
    group.add_argument("--option", action="append", default=[], metavar="NAME=VALUE", help="an option of home_mjx.make")
    group.add_argument("--houses", type=house_count_type, metavar="N", help="number of houses")


def run(args: argparse.Namespace) -> int:
    """Print the report of one state, write the picture unless `--no-picture`, print its path, and return 0.

    Raises:
        ConfigError: The index `--env` is not below the file's number of environments, or as of `_find_spec`.
    """
    from home_mjx.tasks.env.state_io import load_states, read_origin
    from home_mjx.viewer.episodes.state_report import describe_state, draw_state
    from home_mjx.viewer.episodes.video import compose_frame
    from home_mjx.viewer.pictures.media import write_png

    import_modules(args.modules)
    origin = read_origin(args.states)
    if args.env >= origin.num_envs:
        message = f"--env {args.env}: the file has {origin.num_envs} environments"
        raise ConfigError(message, file=args.states, hint=f"Pass 0 to {origin.num_envs - 1}.")
    env = _make_env(args, origin)
    import jax

    state = jax.tree.map(lambda x: x[args.env], load_states(args.states, env))
    with show_compile("the report"):
        lines = describe_state(env, state)
    sys.stdout.write(f"environment {args.env} of {origin.num_envs} in {args.states}\n" + "\n".join(lines) + "\n")
    if args.no_picture:
        return 0
    folder = make_folder(args.out)
    pictures = draw_state(env, state, *args.size)
    found = (next(line for line in lines if line.startswith(name)) for name in ("task", "status"))
    title, status = (" ".join(line.split()) for line in found)
    path = folder / f"{args.states.stem}_{args.env}.png"
    write_png(path, compose_frame(*pictures, title, status))
    sys.stdout.write(f"{path}\n")
    return 0


def _make_env(args: argparse.Namespace, origin: "StateOrigin") -> "Env":
    """Make the environment of `--task`, else that of the file, with the file's house ids if it has any.

    The houses are from `--dataset`, else from the dataset of the environment's spec.
    """
    from home_mjx.env_factory import make
    from home_mjx.houses.load import house_set

    spec = _find_spec(args, origin)
    houses = spec.houses if args.dataset is None else str(args.dataset)
    if origin.house_ids:
        return make(spec.id, house_set(houses, ids=origin.house_ids), **spec.options)
    return make(dataclasses.replace(spec, houses=houses))


def _find_spec(args: argparse.Namespace, origin: "StateOrigin") -> "EnvSpec":
    """Return the spec of `--task`, else that of the file, which must be trusted.

    The former has `--option` over its options, and `--houses`, if given, as its number of houses.

    Raises:
        ConfigError: There is neither, `--option` or `--houses` lacks `--task`, or the task or the id in the file is not
            registered.
    """
    from home_mjx.registry import EnvSpec

    if args.task is not None:
        spec = task_spec(args.task)
        options = {**spec.options, **parse_assignments(args.option)}
        return dataclasses.replace(spec, options=options, num_houses=args.houses or spec.num_houses)
    given = [f"--{name}" for name in ("option", "houses") if getattr(args, name)]
    if given:
        raise ConfigError(f"{given[0]} needs --task", hint="Without --task, the file says which environment it is of.")
    if not origin.spec:
        hint = (
            "Write it with `save_states(path, states, env)`, or name the environment: --task TASK --option NAME=VALUE."
        )
        raise ConfigError("file does not say which environment it is of", file=args.states, hint=hint)
    spec = EnvSpec.from_json(origin.spec)
    spec.check_trusted()
    return spec
