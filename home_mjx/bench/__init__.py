"""What `home-mjx bench` can measure: one module per case, imported when asked for.

A module's `CASES` maps each of its figures (the part after the slash in `rays/primary-depth`) to a function from
`Settings` to `Record`.
"""

import importlib
from collections.abc import Iterator

from home_mjx.bench.record import Record, Settings
from home_mjx.errors import UnknownNameError, did_you_mean

__all__ = ["CASE_NAMES", "Record", "Settings", "measure"]

CASE_NAMES = ("load", "compile", "rays", "physics", "audio", "env")


def measure(name: str, settings: Settings) -> Iterator[Record]:
    """Records of `all`, of a case such as `rays`, or of one figure such as `rays/primary-depth`.

    Raises:
        UnknownNameError: If there is no such case or figure.
    """
    case, _, figure = name.partition("/")
    if case != "all" and case not in CASE_NAMES:
        raise UnknownNameError(f"unknown benchmark case `{name}`", hint=did_you_mean(case, [*CASE_NAMES, "all"]))
    for chosen in CASE_NAMES if case == "all" else (case,):
        figures = importlib.import_module(f"home_mjx.bench.{chosen}").CASES
        if figure and figure not in figures:
            raise UnknownNameError(f"unknown benchmark figure `{name}`", hint=did_you_mean(figure, figures))
        for function in [figures[figure]] if figure else figures.values():
            yield function(settings)
