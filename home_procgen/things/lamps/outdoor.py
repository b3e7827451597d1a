"""Garden lamps."""

from collections.abc import Iterator
from functools import partial

from home_procgen.primitives.family import Bulb
from home_procgen.primitives.solids import cylinder
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import ball
from home_procgen.shapes.sweep import ring, tube
from home_procgen.shapes.transforms import Piece
from home_procgen.things.family import FurnitureFamily, design_kinds
from home_procgen.things.joinery import bulb


def _posts(kind: str) -> Iterator[Piece]:
    yield revolve("iron", [(0.12, 0.0), (0.1, 0.05), (0.04, 0.12), (0.03, 0.3), (0.03, 1.7)], sides=14, steps=2)
    for x in (0.0,) if kind == "post" else (-0.3, 0.3):
        if x:
            yield tube("iron", fillet([(0.0, 1.5, 0.0), (x, 1.45, 0.0), (x, 1.7, 0.0)], 0.15, 5), 0.016)
        yield revolve("iron", [(0.03, 1.68), (0.09, 1.72)], (x, 0.0, 0.0), 6, 1)
        yield revolve("glass", [(0.085, 1.72), (0.12, 1.95)], (x, 0.0, 0.0), 6, 1)
        yield revolve("iron", [(0.14, 1.95), (0.04, 2.05), (0.01, 2.1)], (x, 0.0, 0.0), 6, 1)
        yield from bulb(1.82, 40.0, x, light=2.15)


def _bollard() -> Iterator[Piece]:
    yield cylinder("gray", 0.07, 0.55, sides=20)
    yield cylinder("opal", 0.065, 0.12, (0.0, 0.55, 0.0), sides=20)
    yield revolve("gray", [(0.09, 0.67), (0.09, 0.69), (0.03, 0.71)], sides=20, steps=1)
    for i in range(3):
        yield ring("gray", 0.068, 0.01, (0.0, 0.58 + 0.03 * i, 0.0), 1, 20)
    yield Bulb((0.0, 0.74, 0.0), 20.0)


def _ball_outdoor() -> Iterator[Piece]:
    yield cylinder("black", 0.08, 0.03, sides=18)
    yield ball("opal", 0.17, (0.0, 0.19, 0.0), 24, 14)
    yield Bulb((0.0, 0.39, 0.0), 20.0)


_OUTDOOR_KINDS = {
    "post": partial(_posts, "post"),
    "double": partial(_posts, "double"),
    "bollard": _bollard,
    "ball": _ball_outdoor,
}


def outdoor(kind: str = "post") -> Iterator[Piece]:
    """Build a garden lamp: a post with one or two lanterns, a bollard or a ball on the ground."""
    yield from _OUTDOOR_KINDS[kind]()


FAMILIES = (
    FurnitureFamily("outdoor_lamp", "outdoor_lamp", design_kinds(outdoor, "post", "double", "bollard", "ball")),
)
