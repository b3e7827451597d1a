"""Benchmark cases of `home-mjx bench`: one module per case, imported on demand.

A module's `CASES` maps each of its measurements (the part after the slash in `rays/primary-depth`) to a function from
`BenchSettings` to `Measurement`.
"""

import importlib
import importlib.util
import logging
from collections.abc import Iterator

from benchmarks.cases.record import BenchSettings, Measurement
from home_mjx.errors import UnknownNameError, did_you_mean, install_hint

__all__ = ["CASE_NAMES", "BenchSettings", "Measurement", "measure"]

CASE_NAMES = ("load", "compile", "rays", "physics", "audio", "env", "train")


log = logging.getLogger(__name__)


def measure(name: str, settings: BenchSettings) -> Iterator[Measurement]:
    """Yield the records of `all`, of a case such as `rays`, or of one measurement such as `rays/primary-depth`.

    Raises:
        UnknownNameError: There is no such case or measurement.
    """
    case, _, figure = name.partition("/")
    if case != "all" and case not in CASE_NAMES:
        raise UnknownNameError(f"unknown benchmark case `{name}`", hint=did_you_mean(case, [*CASE_NAMES, "all"]))
    for chosen in _available_cases() if case == "all" else (case,):
        figures = importlib.import_module(f"benchmarks.cases.{chosen}").CASES
        if figure and figure not in figures:
            raise UnknownNameError(f"unknown benchmark measurement `{name}`", hint=did_you_mean(figure, figures))
        for function in [figures[figure]] if figure else figures.values():
            yield function(settings)


def _available_cases() -> tuple[str, ...]:
    """Return the cases that this installation supports."""
    if importlib.util.find_spec("flax") is not None:
        return CASE_NAMES
    log.warning("`train` is skipped, because flax is not installed; %s", install_hint("train"))
    return tuple(name for name in CASE_NAMES if name != "train")
