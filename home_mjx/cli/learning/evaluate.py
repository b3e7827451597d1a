"""Evaluate a trained agent in held-out houses, together with a random agent."""

import argparse
import json
import sys
from pathlib import Path
from typing import Any

from home_mjx.cli.learning.arguments import (
    CHECKPOINT_HELP,
    PACKAGED_AGENT,
    add_episode_option,
    add_import_option,
    find_checkpoint,
    import_modules,
    parse_checkpoint_path,
)
from home_mjx.cli.learning.recipes import Recipe, find_run, plain_value, selected_recipes
from home_mjx.cli.learning.results import format_evaluation, format_kinds, format_results, format_untrained
from home_mjx.cli.output import make_folder
from home_mjx.cli.parsing import house_count_type, parse_dataset, parse_path, parse_seed, positive_int_type
from home_mjx.core.jsonable import parse_assignments
from home_mjx.errors import ConfigError

NUM_HOUSES = 16  # default number of houses


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add `CHECKPOINT`, a path, `demo` or None, `--recipe`, a text or None, and the options of `home-mjx evaluate`.

    `--episodes` and `--houses` are from 1 or None, and `--films` from 1; 0 by default. `--split` is `train`,
    `val` (default) or `test`. `--seed` is from 0 to 2**32 - 1 (0). `--greedy`, `--by-kind` and `--json` are flags.

    `--out` is the path of a folder or None. `--episode-file` and `--import` are as in `learning.arguments`. `--dataset`
    is a path or a text `scheme:...`, see `parse_dataset`; None: that of the run. The repeatable `--env` is a list of
    texts `NAME=VALUE`, which apply to the figures and not to films.
    """
    parser.add_argument("checkpoint", type=parse_checkpoint_path, nargs="?", metavar="CHECKPOINT", help=CHECKPOINT_HELP)
    parser.add_argument(
        "--recipe", metavar="NAME", help="all evaluations of a recipe, or `all`, with the expected results"
    )
    parser.add_argument(
        "--episodes", type=positive_int_type, help="number of episodes (default: 1000, or all of the file)"
    )
    parser.add_argument(
        "--houses", type=house_count_type, help=f"number of houses (default: that of the recipe, or {NUM_HOUSES})"
    )
    parser.add_argument(
        "--split", choices=("train", "val", "test"), default="val", help="split of the dataset (default: val)"
    )
    parser.add_argument("--greedy", action="store_true", help="take the most likely action instead of sampling")
    parser.add_argument("--seed", type=parse_seed, default=0, help="seed of episodes and actions (default: 0)")
    parser.add_argument(
        "--films", type=positive_int_type, default=0, metavar="N", help="film N episodes into the folder `films`"
    )
    parser.add_argument(
        "--out", type=parse_path, help="folder for `films` (default: that of the run; for `demo`, the current one)"
    )
    add_episode_option(parser)
    parser.add_argument(
        "--dataset",
        type=parse_dataset,
        metavar="ROOT",
        help="folder of a dataset, or its name such as procedural:16 (default: that of the run)",
    )
    parser.add_argument(
        "--env", action="append", default=[], metavar="NAME=VALUE",
        help="an option of home_mjx.make that differs from training, such as clip_split=held_out",
    )  # fmt: skip
    add_import_option(parser)
    parser.add_argument("--by-kind", action="store_true", help="list how episodes end by kind of instruction")
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(args: argparse.Namespace) -> int:
    """Evaluate a checkpoint, film episodes with `--films`, print the metrics, and return 0.

    They are the table of `format_evaluation`, with `--by-kind` that of `format_kinds` too, or one line of JSON with
    `--json`. Films go to `films` in `--out`, else beside the checkpoint, or in the current folder for `demo`.
    """
    import_modules(args.modules)
    if args.recipe is not None:
        return _run_recipes(args)
    if args.checkpoint is None:
        raise ConfigError("there is no CHECKPOINT to evaluate", hint="Give one, or --recipe NAME.")
    path = find_checkpoint(args.checkpoint)
    from home_mjx.training import evaluate_checkpoint

    where = {"episode_file": args.episode_file, "dataset": args.dataset}
    changed = parse_assignments(args.env)
    beside = Path() if args.checkpoint == parse_checkpoint_path(PACKAGED_AGENT) else path.parent
    out = make_folder((args.out or beside) / "films") if args.films else None
    houses = args.houses or NUM_HOUSES
    report = evaluate_checkpoint(
        path, args.split, houses, args.episodes, args.seed, args.greedy, **where, options=changed
    )
    if out is not None:
        from home_mjx.viewer.episodes import film_checkpoint

        film_checkpoint(path, out, args.films, args.split, houses, args.seed, args.greedy, **where)
    shown = format_evaluation(report) + (format_kinds(report) if args.by_kind else "")
    sys.stdout.write(json.dumps(report) + "\n" if args.json else shown)
    return 0


def _run_recipes(args: argparse.Namespace) -> int:
    """Run all evaluations of `--recipe`, print a table of each, and return 0.

    The agent is CHECKPOINT, else the run of the recipe, else the published one. With `all`, recipes without any are
    listed with the expected results. The numbers of episodes and houses are those of the recipe, unless given.
    """
    if args.recipe == "all" and args.checkpoint is not None:
        raise ConfigError("--recipe all evaluates the run of each recipe, not a CHECKPOINT", hint="Leave one out.")
    for recipe in selected_recipes(args.recipe):
        path = args.checkpoint or _find_agent(recipe)
        if path is None and args.recipe == "all":
            sys.stdout.write("" if args.json else format_untrained(recipe))
            continue
        results = _evaluate_recipe(recipe, path or find_run(recipe), args)
        shown = {"recipe": recipe.name, "expected": dict(recipe.expected), "results": results}
        sys.stdout.write(json.dumps(shown) + "\n" if args.json else format_results(recipe, results))
        sys.stdout.flush()
    return 0


def _find_agent(recipe: Recipe) -> Path | None:
    """Return the default folder of the recipe's run if there is one, else its published agent, else None."""
    run = find_run(recipe)
    if run.is_dir():
        return run
    return None if recipe.agent is None else parse_checkpoint_path(recipe.agent)


def _evaluate_recipe(recipe: Recipe, path: Path, args: argparse.Namespace) -> dict[str, Any]:
    """Return the report of each evaluation of a recipe, by name, for the agent at `path`."""
    from home_mjx.training import evaluate_checkpoint

    episodes = args.episodes or recipe.arguments.get("episodes")
    houses = args.houses or recipe.arguments.get("held-out", NUM_HOUSES)
    results = {}
    for name, options in recipe.evaluate.items():
        changed = {key: plain_value(value) for key, value in options.items()} | parse_assignments(args.env)
        results[name] = evaluate_checkpoint(
            find_checkpoint(path), args.split, houses, episodes, args.seed, args.greedy, dataset=args.dataset,
            options=changed,
        )  # fmt: skip
    return results
