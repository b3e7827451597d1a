"""Arguments that select a task (also a user-defined one), a trained agent, or options."""

import argparse
import importlib
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from home_mjx.cli.parsing import parse_names, parse_path, whole_number_type
from home_mjx.errors import ConfigError, HomeMjxError

if TYPE_CHECKING:
    from home_mjx.registry import EnvSpec
    from home_mjx.tasks.env.observers import Observer

TASK_HELP = (
    "id of an environment, such as PointNav, its newest version; or module:PointNav, which imports the module first"
)
CHECKPOINT_HELP = "a checkpoint, the folder of a run, or `demo`: the agent that comes with the package"
MAX_PORT = 65535
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


def add_viewer_option(parser: argparse.ArgumentParser) -> None:
    """Add the flag `--viewer`, and its `--port` from 1 (8080)."""
    parser.add_argument("--viewer", action="store_true", help="show the running job in a web browser, at --port")
    parser.add_argument(
        "--port", type=whole_number_type(MAX_PORT), default=8080, help="port, or the next free one (default: 8080)"
    )


def job_viewers(args: argparse.Namespace) -> "list[Observer]":
    """Return the viewer of a job for `--viewer`, which prints its address; else none.

    Raises:
        ConfigError: The extra `view` is not installed, or no port is free.
    """
    if not args.viewer:
        return []
    from home_mjx.viewer.attached.job_viewer import JobViewer
    from home_mjx.viewer.browser.run import ViewOptions

    return [JobViewer(ViewOptions(port=args.port), print_now)]


def print_now(line: str) -> None:
    """Print a line at once, also into a pipe."""
    sys.stdout.write(f"{line}\n")
    sys.stdout.flush()


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
