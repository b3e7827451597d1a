"""The `home-mjx` command. Each subcommand is one module with `add_arguments(parser)` and `run(args) -> int`.

A module may also have `expand_arguments(argv)`, which returns the arguments to parse.

A subcommand's module is imported only when it is called, so that `home-mjx --help` is fast.
"""

import argparse
import importlib
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType

from home_mjx import __version__
from home_mjx.cli.interrupts import EXIT_INTERRUPTED, exit_interrupted, watch_interrupts
from home_mjx.cli.output import drop_empty_folders
from home_mjx.cli.parsing import Parser
from home_mjx.core.checks import check_known
from home_mjx.core.compile_cache import use_compile_cache
from home_mjx.core.progress import command_progress
from home_mjx.errors import ConfigError, HomeMjxError

__all__ = ["main"]

COMMANDS = {
    "demo": "walk agents through houses; write pictures, a video with sound and a report",
    "generate": "generate houses and write them in SUNCG's format",
    "inspect": "count the contents of a house, or validate it",
    "compile": "compile a house or a dataset; write MJCF",
    "export": "write a house as a glTF file",
    "render": "render images of a house from a viewpoint",
    "listen": "render a sound at a listening point of a house",
    "look": "print a saved state (pose, room, contacts, task) and draw its view and plan",
    "doctor": "check whether this machine is ready",
}
LEARNING_COMMANDS = {
    "play": "play and film a task: by an expert, a trained or a random agent, or by yourself with the keyboard",
    "view": "open a task or a house in a web browser: 3D scene, the agent's view, controls",
    "record": "record a dataset of episodes, for imitation learning",
    "train": "train an agent with recurrent PPO, or on an expert's advice",
    "evaluate": "evaluate a trained agent in held-out houses",
}
CHECKOUT_COMMANDS = {"bench": "measure speed (only in a clone of the repository)"}
COMMAND_PACKAGES = {  # package -> its commands, one module each
    "home_mjx.cli.commands": COMMANDS,
    "home_mjx.cli.learning": LEARNING_COMMANDS,
    "benchmarks": CHECKOUT_COMMANDS,
}
ALL_COMMANDS = COMMANDS | LEARNING_COMMANDS | CHECKOUT_COMMANDS
CHECKOUT = Path(__file__).resolve().parents[2]  # root of the repository, if this is a clone
EXIT_BAD_INPUT = 2
LOG_LEVEL_VARIABLE = "TF_CPP_MIN_LOG_LEVEL"  # of XLA, read when JAX is imported: 2 hides warnings, 3 also errors


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line and return the exit code.

    A `HomeMjxError` or `OSError` ends with one message on stderr and code 2, as does a lack of memory; with `--debug`
    the exception is raised. Other exceptions come through, and `--help` and `--version` raise `SystemExit`. No command
    prints the help, with code 2; a closed output pipe gives 0. Without `argv`, the arguments of this process are used,
    and an interrupt ends it with code 130, SIGTERM with 143; with `argv`, 130 is returned.
    """
    is_process = argv is None
    argv = list(sys.argv[1:] if argv is None else argv)
    try:
        if is_process:
            watch_interrupts()
        return _dispatch(argv)
    except KeyboardInterrupt as interrupt:
        if is_process:
            exit_interrupted(*interrupt.args)  # before Python destroys half-built JAX objects
        sys.stderr.write("home-mjx: interrupted\n")
        return EXIT_INTERRUPTED
    except BrokenPipeError:
        # The reader of our output (`| head`) has closed the pipe. Redirect stdout, or flushing at exit fails.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except (HomeMjxError, OSError) as error:
        drop_empty_folders()
        if "--debug" in argv:
            raise
        sys.stderr.write(f"home-mjx: error: {error}\n")
        return EXIT_BAD_INPUT
    except Exception as error:
        if "--debug" in argv or not _is_out_of_memory(error):
            raise
        reason = str(error).strip().partition("\n")[0].rstrip(".")
        hint = "Use fewer environments, houses, episodes or pixels."
        sys.stderr.write(f"home-mjx: error: not enough memory: {reason}. {hint}\n")
        return EXIT_BAD_INPUT


def _is_out_of_memory(error: Exception) -> bool:
    """Return whether NumPy, Python or a device ran out of memory; does not import JAX."""
    return isinstance(error, MemoryError) or (
        type(error).__name__ == "JaxRuntimeError" and "RESOURCE_EXHAUSTED" in str(error)
    )


def _dispatch(argv: list[str]) -> int:
    """Parse the arguments and run the command; return its exit code, or 2 and print the help if there is none.

    JAX's compilation cache is enabled first. An unknown command raises `UnknownNameError`; other errors come through.
    """
    top = _top_parser()
    args = top.parse_args(argv)
    if args.command is None:
        top.print_help()
        return EXIT_BAD_INPUT
    check_known("command", [args.command], ALL_COMMANDS)
    use_compile_cache()
    if args.command != "doctor" and "--debug" not in argv:
        _hide_xla_log()
    module = _load_command(args.command)
    parser = Parser(prog=f"home-mjx {args.command}", description=module.__doc__)
    module.add_arguments(parser)
    with command_progress():
        expand = getattr(module, "expand_arguments", list)
        return module.run(parser.parse_args(expand(args.arguments)))


def _hide_xla_log() -> None:
    """Hide the log of XLA, unless the user has chosen its level; exceptions of XLA are raised as before.

    XLA logs an alarm of six lines as an error when a program compiles for more than two minutes. Our progress shows
    that time already, and the alarm would break its bars.
    """
    os.environ.setdefault(LOG_LEVEL_VARIABLE, "3")


def _load_command(name: str) -> ModuleType:
    """Import and return the module of a known command; raise `ConfigError` if it needs a checkout and there is none.

    For such a command, the checkout is appended to `sys.path`. Errors of the import come through.
    """
    package = next(package for package, names in COMMAND_PACKAGES.items() if name in names)
    if name in CHECKOUT_COMMANDS:
        if not (CHECKOUT / package).is_dir():
            hint = "Clone the repository and install it with `pip install -e .`."
            raise ConfigError(f"`{name}` is part of the repository, not of the installed package", hint=hint)
        if str(CHECKOUT) not in sys.path:
            sys.path.append(str(CHECKOUT))
    return importlib.import_module(f"{package}.{name}")


def _top_parser() -> Parser:
    """Return the parser of `home-mjx` itself, with the list of commands in its help.

    It yields `command`, a text that is not checked or None, and `arguments`: the texts after it, unparsed.
    """
    listing = "\n".join(f"  {name:<10}{text}" for name, text in ALL_COMMANDS.items())
    parser = Parser(
        prog="home-mjx",
        usage="home-mjx [--help] [--version] [--debug] COMMAND ...",
        description="Batch simulator of households for massively parallel reinforcement learning.",
        epilog=f"commands:\n{listing}\n\nSee `home-mjx COMMAND --help` for options.",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=f"home-mjx {__version__}")
    parser.add_argument("command", nargs="?", help=argparse.SUPPRESS)
    parser.add_argument("arguments", nargs=argparse.REMAINDER, help=argparse.SUPPRESS)
    return parser
