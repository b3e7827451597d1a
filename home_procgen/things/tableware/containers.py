"""Jars, tins, boxes."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, box
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import rounded_box
from home_procgen.shapes.sweep import prism
from home_procgen.things.family import FurnitureFamily, design_kinds


def _jars() -> Iterator[Solid]:
    for i, high in enumerate((0.18, 0.145, 0.11)):
        x = (-0.11, 0.0, 0.1)[i]
        yield revolve(
            "glaze",
            [(0.044, 0.0), (0.048, 0.008), (0.048, high - 0.02), (0.042, high - 0.01)],
            (x, 0.0, 0.0),
            18,
            1,
        )
        yield revolve(
            "wood",
            [(0.048, high - 0.01), (0.048, high + 0.008), (0.012, high + 0.012), (0.014, high + 0.026)],
            (x, 0.0, 0.0),
            18,
            1,
        )


def _tins() -> Iterator[Solid]:
    for i in range(3):
        yield revolve(f"bright_{i}", [(0.05, 0.0), (0.05, 0.13)], (-0.11 + 0.11 * i, 0.0, 0.0), 20, 1)
        yield revolve("chrome", [(0.052, 0.128), (0.052, 0.145), (0.045, 0.15)], (-0.11 + 0.11 * i, 0.0, 0.0), 20, 1)


def _spices() -> Iterator[Solid]:
    yield from (box("wood", (0.36, 0.012, 0.08), (0.0, y, 0.0)) for y in (0.0, 0.13))
    yield from (box("wood", (0.012, 0.26, 0.08), (s * 0.18, 0.0, 0.0)) for s in (-1, 1))
    for row in range(2):
        for i in range(6):
            at = (-0.14 + 0.056 * i, 0.012 + 0.13 * row, 0.0)
            yield revolve(
                ("orange", "red", "green", "brown", "yellow", "cream")[(i + row) % 6],
                [(0.02, 0.0), (0.02, 0.06)],
                at,
                12,
                1,
            )
            yield revolve("black", [(0.021, 0.06), (0.021, 0.078)], at, 12, 1)


def _bread_box() -> Iterator[Solid]:
    half = [
        (-0.12, 0.0),
        (0.12, 0.0),
        *[(0.12 * np.cos(a), 0.03 + 0.16 * np.sin(a)) for a in np.linspace(0, np.pi, 11)],
    ]
    yield prism("bright", half, 0.36, (0.0, 0.0, 0.0), "side")
    yield rounded_box("chrome", (0.1, 0.014, 0.02), (0.0, 0.05, 0.125), 0.005, 2)
    for x in (-0.175, 0.175):
        yield prism("wood", [(1.05 * z, 1.03 * y) for z, y in half], 0.014, (x, 0.0, 0.0), "side")


_CONTAINERS_KINDS = {
    "jars": _jars,
    "tins": _tins,
    "spices": _spices,
    "bread": _bread_box,
}


def containers(kind: str = "jars") -> Iterator[Solid]:
    """Build three jars with lids, tins, a spice rack or a bread box."""
    yield from _CONTAINERS_KINDS[kind]()


FAMILIES = (FurnitureFamily("containers", "containers", design_kinds(containers, "jars", "tins", "spices", "bread")),)
