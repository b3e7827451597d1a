"""Arguments that select a task (also a user-defined one), a trained agent, or options."""

import argparse
import importlib
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from home_mjx.cli.parsing import parse_names, parse_path
from home_mjx.errors import ConfigError, HomeMjxError

if TYPE_CHECKING:
    from home_mjx.registry import EnvSpec

TASK_HELP = (
    "id of an environment, such as PointNav, its newest version; or module:PointNav, which imports the module first"
)
CHECKPOINT_HELP = "a checkpoint, the folder of a run, or `demo`: the agent that comes with the package"
PACKAGED_AGENT = "demo"  # name of the packaged agent; use `./demo` for a folder of this name


def add_import_option(parser: argparse.ArgumentParser) -> None:
    """Add the repeatable `--import MODULE`: a list `modules` for `import_modules`, empty by default."""
    parser.add_argument(
        "--import", dest="modules", action="append", default=[], metavar="MODULE",
        help="import a module first, such as one that registers your tasks, shaders or datasets",
    )  # fmt: skip


def add_sensors_option(parser: argparse.ArgumentParser, text: str) -> None:
    """Add `--sensors A,B`, a tuple of names that are not checked, with help `text`; None by default."""
    parser.add_argument("--sensors", type=parse_names, metavar="A,B", help=text)


def add_episode_option(parser: argparse.ArgumentParser) -> None:
    """Add `--episode-file FILE`, a path of episodes or tasks to use, which may not exist; None by default."""
    parser.add_argument(
        "--episode-file", type=parse_path, metavar="FILE",
        help="use the episodes of a file of save_episodes or save_tasks, in order, in the houses that it names",
    )  # fmt: skip


def add_observe_option(parser: argparse.ArgumentParser, example: str) -> None:
    """Add the repeatable `--observe NAME`: a list `observers`, empty by default; its help has the name `example`."""
    parser.add_argument(
        "--observe", dest="observers", action="append", default=[], metavar="NAME",
        help=f"add an observer that is registered under this name, such as {example}; see --import",
    )  # fmt: skip


def import_modules(modules: list[str]) -> None:
    """Import user modules, installed or from the current folder, which is appended to `sys.path`.

    Only an argument may name a module, never a file such as a checkpoint.

    Raises:
        ConfigError: A module cannot be imported. Typed errors of this package that it raises come through.
    """
    here = os.getcwd()
    if modules and here not in sys.path:
        sys.path.append(here)  # last, so that no file here shadows an installed module
    for name in modules:
        try:
            importlib.import_module(name)
        except HomeMjxError:
            raise
        except Exception as error:  # user code may raise anything
            hint = "Use its import name. It must be installed or in the current folder. `--debug` shows the traceback."
            message = f"module `{name}` cannot be imported: {type(error).__name__}: {error}"
            raise ConfigError(message, hint=hint) from error


def task_spec(task: str) -> "EnvSpec":
    """Return the spec of a task by its id, its name alone (the newest version), or `module:name` as in Gymnasium.

    Raises:
        ConfigError: The task is unknown, or the module cannot be imported.

    Example:
        >>> task_spec("PointNav").id
        'PointNav-v0'
    """
    from home_mjx.registry import find_spec

    module, colon, name = task.rpartition(":")
    import_modules([module] if colon else [])
    return find_spec(newest_version(name))


def newest_version(task: str) -> str:
    """Return the id of a task's newest version if the name has no version; any other name is returned unchanged."""
    from home_mjx.registry import list_envs

    versions = [env_id for env_id in list_envs() if env_id.rpartition("-v")[0] == task]
    return max(versions, key=lambda env_id: int(env_id.rpartition("-v")[2]), default=task)


def parse_checkpoint_path(text: str) -> Path:
    """Convert an argument to a path, which may not exist; `demo` selects the packaged agent.

    A blank text, or one with a null byte, raises `ArgumentTypeError`; see `parse_path`.

    Example:
        >>> parse_checkpoint_path("demo").name
        'agent.npz'
    """
    if text != PACKAGED_AGENT:
        return parse_path(text)
    from home_mjx.viewer.demo.search import AGENT_FILE

    return AGENT_FILE


def find_checkpoint(path: Path) -> Path:
    """Return the path of the checkpoint in the folder of a run, which may not exist; any other path unchanged.

    Raises:
        ConfigError: The extra `train` is not installed.
    """
    from home_mjx.training import CHECKPOINT_FILE  # raises ConfigError if the extra `train` is not installed

    return path / CHECKPOINT_FILE if path.is_dir() else path
