"""Results of evaluations as text: of one agent, and of recipes beside the expected ones."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from home_mjx.cli.learning.recipes import Recipe

if TYPE_CHECKING:
    from home_mjx.training import RunConfig

LEADING_METRICS = ("success", "spl", "soft_spl", "return", "episode_steps")  # metrics that come first
COLUMNS = f"{'success':>16}{'expected':>10}{'random':>10}{'SPL':>10}"


def format_evaluation(report: dict[str, Any]) -> str:
    """Format the report of `evaluate_checkpoint` as a table: means ± standard errors of the trained and a random agent.

    The first line has titles. A row per metric follows, first `LEADING_METRICS`, then the others in the report's order.
    The last line has number of episodes and houses, split, kind of actions, and seed. The text ends with a newline.

    Example:
        >>> figures = {"success": {"mean": 0.5, "stderr": 0.01}}
        >>> report = {"trained": figures, "random": figures, "episodes": 10, "houses": 2, "split": "val"}
        >>> print(format_evaluation(report | {"actions": "sampled", "seed": 0}).splitlines()[1].split())
        ['success', '0.500', '±', '0.010', '0.500', '±', '0.010']
    """
    trained, chance = report["trained"], report["random"]
    names = [name for name in LEADING_METRICS if name in trained] + [
        name for name in trained if name not in LEADING_METRICS
    ]
    rows = [f"{'':<12}{'trained':>18}{'random':>18}"]
    for name in names:
        shown = (f"{figures[name]['mean']:.3f} ± {figures[name]['stderr']:.3f}" for figures in (trained, chance))
        rows.append(f"{name:<12}" + "".join(f"{text:>18}" for text in shown))
    rows.append(
        f"{report['episodes']} episodes in {report['houses']} houses ({report['split'] or 'those of training'}), "
        f"actions {report['actions']}, seed {report['seed']}"
    )
    return "\n".join(rows) + "\n"


def format_kinds(report: Mapping[str, Any]) -> str:
    """Format `kinds` of a report, see `failures_by_kind`, as a table; empty without instructions.

    Example:
        >>> figures = {"episodes": 9.0, "success": 0.5, "wrong": 0.25, "late": 0.25, "begun": 0.125}
        >>> print(format_kinds({"kinds": {"a colour": figures}}).splitlines()[1].split())
        ['a', 'colour', '9', '0.500', '0.250', '0.250', '0.125']
    """
    names = ("success", "wrong", "late", "begun")
    rows = [f"{'instructions with':<24}{'episodes':>10}" + "".join(f"{name:>10}" for name in names)]
    for kind, figures in report.get("kinds", {}).items():
        rows.append(f"{kind:<24}{figures['episodes']:>10.0f}" + "".join(f"{figures[name]:>10.3f}" for name in names))
    return "\n".join(rows) + "\n" if len(rows) > 1 else ""


def format_results(recipe: Recipe, results: Mapping[str, Mapping[str, Any]]) -> str:
    """Format success and SPL of each evaluation of a recipe, the expected success and that of random actions."""
    rows = [f"{recipe.name:<24}{COLUMNS}"]
    for name, report in results.items():
        trained, chance = report["trained"], report["random"]
        success = f"{trained['success']['mean']:.3f} ± {trained['success']['stderr']:.3f}"
        spl = f"{trained['spl']['mean']:.3f}" if "spl" in trained else "-"
        rows.append(_row(name, success, _expected(recipe, name), f"{chance['success']['mean']:.3f}", spl))
    return "\n".join(rows) + "\n"


def format_untrained(recipe: Recipe) -> str:
    """Format the expected results of a recipe without an agent here, or that none has ever been trained.

    Example:
        >>> print(format_untrained(Recipe("short", "PointNav")), end="")
        short                   not trained yet, here or anywhere
    """
    if not recipe.expected:
        return f"{recipe.name:<24}not trained yet, here or anywhere\n"
    rows = [f"{recipe.name:<24}not trained here: home-mjx train --recipe {recipe.name}"]
    rows += [_row(name, "-", _expected(recipe, name), "-", "-") for name in recipe.evaluate]
    return "\n".join(rows) + "\n"


def _expected(recipe: Recipe, name: str) -> str:
    """Return the expected success of an evaluation as text; `-` if it is unknown."""
    return f"{recipe.expected[name]:.3f}" if name in recipe.expected else "-"


def _row(name: str, success: str, expected: str, chance: str, spl: str) -> str:
    """Return the row of an evaluation, in the columns of `COLUMNS`."""
    return f"  {name:<22}{success:>16}{expected:>10}{chance:>10}{spl:>10}"


def format_card(config: "RunConfig", report: Mapping[str, Any]) -> str:
    """Format the card of a trained agent in Markdown: task, data, options, results and limits.

    Args:
        config: Configuration of its run.
        report: Report of `evaluate_checkpoint` in held-out houses.

    Returns:
        A text that ends with a newline. Limits are those that follow from the options; others are for the author.
    """
    spec, ppo = config.env, config.ppo
    options = {name: value for name, value in spec.options.items() if name != "sensors"}
    success = [name for name in ("success", "spl") if name in report["trained"]]
    figures = ", ".join(
        f"{name} {report['trained'][name]['mean']:.3f} ± {report['trained'][name]['stderr']:.3f} "
        f"(random {report['random'][name]['mean']:.3f})"
        for name in success
    )
    time = "" if config.max_seconds is None else f", at most {config.max_seconds:g} s"
    clone = f"{config.clone_timesteps} steps of an expert's advice, then " if config.clone_timesteps else ""
    rows = {
        "Task": f"{spec.id}, observing {', '.join(spec.options.get('sensors') or ('all sensors of the task',))}",
        "Data": f"{spec.num_houses} houses of {spec.houses or 'the default dataset'}, split {spec.split}",
        "Options": ", ".join(f"{name} = {value}" for name, value in options.items()) or "defaults",
        "Training": f"{clone}at most {ppo.num_timesteps} steps of {config.algorithm}{time}, seed {config.seed}",
        "Results": f"{figures}; {report['episodes']} episodes in {report['houses']} houses of split "
        f"{report['split'] or 'of training'}, actions {report['actions']}, on {report['device']}",
        "Limits": "one seed; other datasets, sensors and options than these were not tried",
    }
    table = "\n".join(f"| {name} | {text} |" for name, text in rows.items())
    return f"# Agent for {spec.id}\n\n| Card | |\n| --- | --- |\n{table}\n"
