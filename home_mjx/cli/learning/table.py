"""Evaluation results as a text table."""

from typing import Any

LEADING_METRICS = ("success", "spl", "soft_spl", "return", "episode_steps")  # metrics that come first


def format_evaluation(report: dict[str, Any]) -> str:
    """Format the report of `evaluate_checkpoint` as a table of means and standard errors.

    Example:
        >>> figures = {"success": {"mean": 0.5, "stderr": 0.01}}
        >>> report = {"trained": figures, "random": figures, "episodes": 10, "houses": 2, "split": "val"}
        >>> print(as_table(report | {"actions": "sampled", "seed": 0}).splitlines()[1].split())
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
