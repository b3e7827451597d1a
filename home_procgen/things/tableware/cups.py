"""Cups."""

from collections.abc import Iterator

from home_procgen.primitives.solids import Solid, cylinder, move
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.revolve import revolve, vessel
from home_procgen.shapes.rounded import rounded_box
from home_procgen.shapes.sweep import ring, rod, tube
from home_procgen.things.family import FurnitureFamily, design_kinds


def _ear(slot: str, radius: float, low: float, high: float, bar: float = 0.005) -> Solid:
    """Build a handle on the +x side of a cup."""
    path = fillet(
        [(radius, high, 0.0), (radius + 0.032, high, 0.0), (radius + 0.03, low, 0.0), (radius, low, 0.0)], 0.018, 4
    )
    return tube(slot, path, bar, 8)


def _mug() -> Iterator[Solid]:
    yield vessel("crockery", [(0.038, 0.0), (0.041, 0.006), (0.041, 0.09), (0.042, 0.095)], 0.004, sides=20, steps=1)
    yield cylinder("brown", 0.036, 0.002, (0.0, 0.08, 0.0), sides=18)
    yield _ear("crockery", 0.04, 0.022, 0.076, 0.006)


def _tea() -> Iterator[Solid]:
    yield vessel("crockery", [(0.035, 0.0), (0.05, 0.006), (0.076, 0.018)], 0.003, sides=24, steps=2)
    yield vessel(
        "crockery", [(0.02, 0.0), (0.022, 0.008), (0.04, 0.03), (0.047, 0.065)], 0.003, (0.0, 0.005, 0.0), 20, 3
    )
    yield _ear("crockery", 0.042, 0.03, 0.058, 0.004)
    yield cylinder("brown", 0.04, 0.002, (0.0, 0.052, 0.0), sides=18)


def _enamel() -> Iterator[Solid]:
    yield vessel("white", [(0.04, 0.0), (0.042, 0.08)], 0.003, sides=20, steps=1)
    yield ring("blue", 0.0415, 0.004, (0.0, 0.08, 0.0), 1, 20)
    yield _ear("white", 0.041, 0.015, 0.065, 0.004)


def _bowl() -> Iterator[Solid]:
    yield vessel("glaze", [(0.03, 0.0), (0.032, 0.008), (0.06, 0.03), (0.068, 0.06)], 0.004, sides=22, steps=3)
    for s in (-1, 1):
        yield rounded_box("glaze", (0.03, 0.012, 0.03), (s * 0.075, 0.045, 0.0), 0.005, 2)


def _footed() -> Iterator[Solid]:
    yield vessel(
        "glaze", [(0.03, 0.0), (0.02, 0.01), (0.014, 0.02), (0.035, 0.04), (0.04, 0.1)], 0.004, sides=20, steps=3
    )
    yield _ear("glaze", 0.038, 0.045, 0.09, 0.005)


def _travel() -> Iterator[Solid]:
    yield revolve("bright", [(0.032, 0.0), (0.035, 0.01), (0.042, 0.15)], sides=20, steps=1)
    yield revolve("black", [(0.043, 0.15), (0.043, 0.165), (0.036, 0.178)], sides=20, steps=1)
    yield revolve("rubber", [(0.0395, 0.06), (0.042, 0.1)], sides=20, steps=1)


def _espresso() -> Iterator[Solid]:
    yield vessel("crockery", [(0.028, 0.0), (0.05, 0.01)], 0.003, sides=22, steps=1)
    yield vessel("crockery_1", [(0.018, 0.0), (0.028, 0.02), (0.03, 0.05)], 0.003, (0.0, 0.004, 0.0), 18, 2)
    yield _ear("crockery_1", 0.027, 0.02, 0.042, 0.004)
    yield rod("chrome", (-0.03, 0.012, 0.035), (0.03, 0.014, 0.035), 0.0025, sides=6)


def _stack() -> Iterator[Solid]:
    for i in range(3):
        yield vessel(
            f"crockery_{i}", [(0.026, 0.0), (0.04, 0.03), (0.042, 0.055)], 0.003, (0.003 * i, 0.028 * i, 0.0), 18, 2
        )
        yield move(_ear(f"crockery_{i}", 0.038, 0.015, 0.045, 0.004), (0.003 * i, 0.028 * i, 0.0))


def _hex() -> Iterator[Solid]:
    yield vessel("glaze", [(0.036, 0.0), (0.044, 0.03), (0.044, 0.09)], 0.005, sides=6, steps=1)
    yield _ear("glaze", 0.038, 0.025, 0.075, 0.007)
    yield cylinder("cream", 0.034, 0.002, (0.0, 0.078, 0.0), sides=12)
    yield ring("brass", 0.041, 0.003, (0.0, 0.09, 0.0), 1, 6)


def _pens() -> Iterator[Solid]:
    yield vessel("glaze", [(0.03, 0.0), (0.036, 0.02), (0.034, 0.06), (0.038, 0.1)], 0.004, sides=20, steps=3)
    for i in range(5):
        yield rod("wood", (0.01 * (i - 2), 0.02, 0.0), (0.022 * (i - 2), 0.17, 0.012 * (-1) ** i), 0.003, sides=6)


_CUP_KINDS = {
    "mug": _mug,
    "tea": _tea,
    "enamel": _enamel,
    "bowl": _bowl,
    "footed": _footed,
    "travel": _travel,
    "espresso": _espresso,
    "stack": _stack,
    "hex": _hex,
    "pens": _pens,
}


def cup(kind: str = "mug") -> Iterator[Solid]:
    """Build a cup of one of ten kinds, such as a mug, a tea cup with its saucer, a stack or a pen cup."""
    yield from _CUP_KINDS[kind]()


FAMILIES = (
    FurnitureFamily(
        "cup",
        "cup",
        design_kinds(cup, "mug", "tea", "enamel", "bowl", "footed", "travel", "espresso", "stack", "hex", "pens"),
    ),
)
