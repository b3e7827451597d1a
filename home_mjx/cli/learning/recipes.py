"""Recipes: files with all options of a training, its evaluations and their expected results."""

import argparse
import json
import tomllib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from home_mjx.cli.parsing import Parser
from home_mjx.core.files import read_text
from home_mjx.core.jsonable import parse_assignments
from home_mjx.errors import DatasetError, MissingFileError, UnknownNameError, did_you_mean

FOLDER = Path(__file__).resolve().parents[3] / "examples" / "recipes"  # of a clone of the repository
MAX_BYTES = 100_000
TABLES = ("env", "ppo", "evaluate", "expected")
OTHERS = ("task", "agent", "curve")  # entries that are neither tables nor arguments
ARGUMENTS = (
    *("dataset", "sensors", "houses", "held-out", "episodes", "clone-steps", "steps", "seconds", "seed"),
    *("algorithm", "num-envs", "validate"),
)
HINT = "See the files in examples/recipes."
NOTHING = "none"  # TOML has no null


@dataclass(frozen=True)
class Recipe:
    """Options of a training.

    Attributes:
        name: Name of the file without its ending.
        task: Argument TASK of `home-mjx train`.
        arguments: Its further arguments by name, without dashes in front.
        env: Options of `home_mjx.make`.
        ppo: Options of `PPOConfig`.
        evaluate: Options that differ from those of training, by name of the evaluation.
        expected: Success rate of each evaluation; empty: no agent has been trained by it yet.
        agent: Checkpoint of a published agent, as on the command line; None: there is none.
        curve: Success rate during training by environment steps, in pairs.
    """

    name: str
    task: str
    arguments: Mapping[str, Any] = field(default_factory=dict)
    env: Mapping[str, Any] = field(default_factory=dict)
    ppo: Mapping[str, Any] = field(default_factory=dict)
    evaluate: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    expected: Mapping[str, float] = field(default_factory=dict)
    agent: str | None = None
    curve: tuple[tuple[int, float], ...] = ()

    @property
    def argv(self) -> list[str]:
        """The arguments of `home-mjx train` for this recipe.

        Example:
            >>> Recipe("short", "PointNav", {"steps": 1000}, ppo={"memory": 64}).argv
            ['--steps=1000', '--ppo=memory=64', 'PointNav']
        """
        plain = [f"--{name}={value}" for name, value in self.arguments.items()]
        named = [(table, item) for table in ("env", "ppo") for item in getattr(self, table).items()]
        return [*plain, *(f"--{table}={name}={json.dumps(plain_value(x))}" for table, (name, x) in named), self.task]


def plain_value(value: Any) -> Any:
    """Return a value of TOML as `make` takes it: the text `none` is None."""
    return None if value == NOTHING else value


def list_recipes() -> list[str]:
    """Return the names of the recipes of this clone of the repository, sorted; none in an installed package."""
    return sorted(path.stem for path in FOLDER.glob("*.toml"))


def read_recipe(name: str) -> Recipe:
    """Read a recipe by its name, or from a file that ends in `.toml`.

    Raises:
        UnknownNameError: No recipe has this name.
        MissingFileError: The file does not exist.
        DatasetError: The file is not TOML, or has unknown or wrong entries; the error names the first one.
    """
    path = Path(name) if name.endswith(".toml") else FOLDER / f"{name}.toml"
    if not name.endswith(".toml") and name not in list_recipes():
        raise UnknownNameError(f"unknown recipe `{name}`", hint=did_you_mean(name, list_recipes()))
    if not path.is_file():
        raise MissingFileError("there is no such recipe", file=path)
    try:
        content = tomllib.loads(read_text(path, max_bytes=MAX_BYTES))
    except tomllib.TOMLDecodeError as error:
        raise DatasetError(f"recipe is not TOML: {error}", file=path, hint=HINT) from error
    return _recipe(path, content)


def _recipe(path: Path, content: dict[str, Any]) -> Recipe:
    """Return the recipe of a file's content; raise `DatasetError` for unknown or wrong entries."""
    for key, value in content.items():
        if key not in (*TABLES, *ARGUMENTS, *OTHERS):
            hint = did_you_mean(key, (*TABLES, *ARGUMENTS, *OTHERS))
            raise DatasetError("unknown entry of a recipe", file=path, element=key, hint=hint)
        if isinstance(value, dict) != (key in TABLES):
            kind = "a table" if key in TABLES else "a number or text"
            raise DatasetError(f"entry must be {kind}", file=path, element=key, hint=HINT)
    if not isinstance(content.get("task"), str):
        raise DatasetError("recipe has no task", file=path, element="task", hint=HINT)
    judged, wanted = content.get("evaluate", {}), content.get("expected", {})
    for name, options in judged.items():
        if not isinstance(options, dict):
            raise DatasetError(
                "evaluation must be a table of options", file=path, element=f"evaluate.{name}", hint=HINT
            )
    for name, value in wanted.items():
        if name not in judged or not isinstance(value, int | float):
            message = "expected result needs a number, and an evaluation of its name"
            raise DatasetError(message, file=path, element=f"expected.{name}", hint=HINT)
    agent, curve = content.get("agent"), _curve(path, content.get("curve", []))
    if agent is not None and not isinstance(agent, str):
        raise DatasetError("agent must be the name of a checkpoint", file=path, element="agent", hint=HINT)
    arguments = {name: content[name] for name in ARGUMENTS if name in content}
    options = content.get("env", {}), content.get("ppo", {}), judged, wanted
    return Recipe(path.stem, content["task"], arguments, *options, agent, curve)


def _curve(path: Path, points: Any) -> tuple[tuple[int, float], ...]:
    """Return the points of a curve; raise `DatasetError` unless they are pairs of growing steps and success rates."""
    is_pair = lambda x: isinstance(x, list) and len(x) == 2 and all(isinstance(y, int | float) for y in x)  # noqa: E731
    if not isinstance(points, list) or not all(map(is_pair, points)):
        raise DatasetError("curve must be pairs of steps and success", file=path, element="curve", hint=HINT)
    steps = [point[0] for point in points]
    if steps != sorted(set(steps)) or not all(0 <= point[1] <= 1 for point in points):
        message = "curve needs growing steps and success rates from 0 to 1"
        raise DatasetError(message, file=path, element="curve", hint=HINT)
    return tuple((int(step), float(success)) for step, success in points)


def expand_recipe(argv: list[str]) -> list[str]:
    """Return the arguments of `home-mjx train` with those of its `--recipe` in front, so that the user's count.

    Without `--recipe` they are unchanged. Raises as `read_recipe`.
    """
    name = recipe_name(argv)
    return argv if name is None else [*read_recipe(name).argv, *argv]


def recipe_name(argv: list[str]) -> str | None:
    """Return the last value of `--recipe NAME` or `--recipe=NAME`; None if there is none.

    Example:
        >>> recipe_name(["--steps", "5", "--recipe=objectnav"])
        'objectnav'
    """
    found = argparse.ArgumentParser(add_help=False, allow_abbrev=False, exit_on_error=False)
    found.add_argument("--recipe")
    try:
        return found.parse_known_args(argv)[0].recipe
    except argparse.ArgumentError:  # it has no value; the parser of the command says so
        return None


def changed_options(args: argparse.Namespace, recipe: Recipe, add_arguments: Callable[[Any], None]) -> Iterator[str]:
    """Yield a line for each option of `args` that differs from its value in the recipe.

    `add_arguments` adds the arguments to a parser. `out`, `resume`, `modules`, `observers` and those of several
    processes are not compared.
    """
    parser = Parser()
    add_arguments(parser)
    own = vars(parser.parse_args([*recipe.argv, "--recipe", recipe.name]))
    skipped = ("out", "resume", "modules", "observers", "recipe", "env", "ppo", "coordinator", "processes", "process")
    pairs = {name: (own[name], value) for name, value in vars(args).items() if name not in skipped}
    for table in ("env", "ppo"):
        before, after = parse_assignments(own[table]), parse_assignments(getattr(args, table))
        pairs |= {f"{table} {name}": (before.get(name), value) for name, value in after.items()}
    for name, (before, after) in pairs.items():
        if before != after:
            yield f"{name}: {after} instead of {before}"


def find_run(recipe: Recipe) -> Path:
    """Return the folder in which `home-mjx train --recipe` puts a run by default."""
    return Path("runs") / recipe.name


def selected_recipes(name: str) -> list[Recipe]:
    """Return the recipe of a name, or for `all` those of this clone; raises as `read_recipe`."""
    return [read_recipe(name)] if name != "all" else [read_recipe(one) for one in list_recipes()]
