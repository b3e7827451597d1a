"""Jugs and teapots."""

from collections.abc import Iterator

from home_procgen.primitives.solids import Solid
from home_procgen.shapes.curves import fillet, spline
from home_procgen.shapes.revolve import revolve, vessel
from home_procgen.shapes.sweep import prism, tube
from home_procgen.things.family import FurnitureFamily, design_kinds


def _pitcher() -> Iterator[Solid]:
    yield vessel(
        "glaze", [(0.05, 0.0), (0.075, 0.05), (0.06, 0.14), (0.045, 0.19), (0.055, 0.23)], 0.005, sides=22, steps=3
    )
    yield prism("glaze", [(-0.045, 0.19), (-0.085, 0.232), (-0.045, 0.228)], 0.03)
    yield tube(
        "glaze", fillet([(0.05, 0.2, 0.0), (0.12, 0.2, 0.0), (0.11, 0.08, 0.0), (0.07, 0.06, 0.0)], 0.05, 4), 0.009
    )


def _carafe() -> Iterator[Solid]:
    yield vessel(
        "glass",
        [(0.06, 0.0), (0.075, 0.03), (0.06, 0.1), (0.022, 0.16), (0.024, 0.2), (0.04, 0.23)],
        0.003,
        sides=24,
        steps=3,
    )
    yield revolve("water", [(0.057, 0.006), (0.071, 0.03), (0.06, 0.085)], sides=20, steps=2)


def _thermos() -> Iterator[Solid]:
    yield revolve("bright", [(0.055, 0.0), (0.06, 0.01), (0.06, 0.18), (0.04, 0.22), (0.038, 0.25)], sides=22, steps=2)
    yield revolve("black", [(0.042, 0.25), (0.045, 0.26), (0.03, 0.29), (0.01, 0.295)], sides=18, steps=1)
    yield tube("black", fillet([(0.04, 0.24, 0.0), (0.11, 0.23, 0.0), (0.1, 0.08, 0.0), (0.06, 0.07, 0.0)], 0.04), 0.01)


_JUG_KINDS = {
    "pitcher": _pitcher,
    "carafe": _carafe,
    "thermos": _thermos,
}


def jug(kind: str = "pitcher") -> Iterator[Solid]:
    """Build a pitcher, a carafe or a thermos."""
    yield from _JUG_KINDS[kind]()


def teapot(kind: str = "round") -> Iterator[Solid]:
    """Build a round, tall or glass teapot."""
    slot = "tint" if kind == "glass" else "glaze"
    body = (
        [(0.05, 0.0), (0.085, 0.05), (0.07, 0.1), (0.035, 0.118)]
        if kind != "tall"
        else [(0.05, 0.0), (0.055, 0.02), (0.05, 0.13), (0.035, 0.16)]
    )
    top = body[-1][1]
    yield revolve(slot, body, sides=24, steps=3)
    yield revolve(
        "glaze",
        [(0.037, top - 0.003), (0.03, top + 0.008), (0.01, top + 0.014), (0.012, top + 0.026), (0.004, top + 0.032)],
        sides=16,
        steps=2,
    )
    yield tube(
        slot,
        spline([(0.07, 0.035, 0.0), (0.105, 0.06, 0.0), (0.12, top - 0.01, 0.0), (0.14, top, 0.0)], 3),
        [0.016, 0.014, 0.012, 0.011, 0.01, 0.009, 0.008, 0.007, 0.006, 0.006],
    )
    yield tube(
        slot,
        fillet(
            [(-0.06, 0.85 * top, 0.0), (-0.125, 0.9 * top, 0.0), (-0.12, 0.3 * top, 0.0), (-0.07, 0.3 * top, 0.0)],
            0.04,
            4,
        ),
        0.008,
    )


FAMILIES = (
    FurnitureFamily("jug", "jug", design_kinds(jug, "pitcher", "carafe", "thermos")),
    FurnitureFamily("teapot", "teapot", design_kinds(teapot, "round", "tall", "glass")),
)
