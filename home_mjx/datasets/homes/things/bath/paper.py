"""Paper and soap."""

from collections.abc import Iterator

import numpy as np

from home_mjx.datasets.homes.shapes.curves import fillet
from home_mjx.datasets.homes.shapes.sheets import surface
from home_mjx.datasets.homes.shapes.soft import ball, rounded, soft
from home_mjx.datasets.homes.shapes.swept import rod, tube
from home_mjx.datasets.homes.shapes.turned import turned, vessel
from home_mjx.datasets.homes.things.family import Family, design, kinds_of
from home_mjx.datasets.procedural.primitives.solids import Solid, cylinder, move, rotate


def _roll(x: float, y: float, z: float) -> Solid:
    return turned("white", [(0.055, 0.0), (0.055, 0.1)], (x, y, z), 22, 1)


def _paper_holder() -> Iterator[Solid]:
    yield rounded("chrome", (0.05, 0.05, 0.012), (0.08, 0.09, -0.07), 0.005, 1)
    yield tube("chrome", fillet([(0.08, 0.115, -0.065), (0.08, 0.115, 0.0), (-0.08, 0.115, 0.0)], 0.02), 0.006)
    yield move(rotate(_roll(0.0, -0.05, 0.0), 2, np.pi / 2), (0.0, 0.115, 0.0))
    yield surface(
        "white", lambda u, v: ((u - 0.5) * 0.098, 0.115 - 0.115 * v, 0.056 + 0.006 * np.sin(3 * v)), 3, 5, 0.002
    )


def _paper_stand() -> Iterator[Solid]:
    yield turned("chrome", [(0.09, 0.0), (0.085, 0.012), (0.01, 0.02)], sides=22, steps=1)
    yield rod("chrome", (0.0, 0.01, 0.0), (0.0, 0.6, 0.0), 0.008)
    for i in range(3):
        yield _roll(0.0, 0.03 + 0.105 * i, 0.0)
    yield ball("chrome", 0.016, (0.0, 0.61, 0.0), 10, 6)
    yield tube("chrome", fillet([(0.0, 0.52, 0.0), (0.1, 0.52, 0.0), (0.1, 0.52, 0.01)], 0.01), 0.006)


def _paper_basket() -> Iterator[Solid]:
    yield vessel("cane", [(0.14, 0.0), (0.16, 0.06), (0.16, 0.14)], 0.008, sides=24, steps=1)
    for i in range(3):
        a = 2 * np.pi * i / 3
        yield _roll(0.075 * np.cos(a), 0.012, 0.075 * np.sin(a))
        yield _roll(0.065 * np.cos(a + 1), 0.114, 0.065 * np.sin(a + 1))


_PAPER_KINDS = {
    "wall": _paper_holder,
    "stand": _paper_stand,
    "basket": _paper_basket,
}


def paper(kind: str = "wall") -> Iterator[Solid]:
    """A roll on a holder, on a stand, or a pile of rolls."""
    yield from _PAPER_KINDS[kind]()


def soap(kind: str = "pump") -> Iterator[Solid]:
    """A pump bottle, or a foam one."""
    shape = (
        [(0.034, 0.0), (0.037, 0.01), (0.035, 0.1), (0.014, 0.13)]
        if kind == "pump"
        else [(0.03, 0.0), (0.04, 0.05), (0.03, 0.1), (0.016, 0.12)]
    )
    yield turned("glaze" if kind == "pump" else "tint", shape, sides=20, steps=2)
    yield cylinder("chrome", 0.017, 0.02, (0.0, 0.12, 0.0), sides=14)
    yield rod("chrome", (0.0, 0.13, 0.0), (0.0, 0.165, 0.0), 0.006)
    yield tube("chrome", fillet([(0.0, 0.165, -0.012), (0.0, 0.17, 0.03), (0.0, 0.16, 0.05)], 0.01), 0.007)


def soap_dish() -> Iterator[Solid]:
    """A bar of soap on an oval dish."""
    yield vessel("crockery", [(0.035, 0.0), (0.045, 0.008), (0.06, 0.025)], 0.004, sides=26, steps=2, stretch=0.7)
    yield soft("bright", (0.075, 0.026, 0.045), (0.0, 0.01, 0.0), 3.0, 5)


FAMILIES = (
    Family("toilet_paper", "toilet_paper", kinds_of(paper, "wall", "stand", "basket")),
    Family("soap_dispenser", "soap_dispenser", kinds_of(soap, "pump", "foam")),
    Family("soap_dish", "soap_dish", (design(soap_dish),)),
)
