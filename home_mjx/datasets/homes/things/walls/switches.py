"""Switches and sockets."""

from collections.abc import Iterator

from home_mjx.datasets.homes.shapes.soft import rounded
from home_mjx.datasets.homes.shapes.swept import ring
from home_mjx.datasets.homes.things.family import Family, kinds_of
from home_mjx.datasets.homes.things.joinery import disc
from home_mjx.datasets.procedural.primitives.solids import Solid, box, rotate


def switch(kind: str = "switch") -> Iterator[Solid]:
    """A light switch, a double one, a socket, two sockets, a dimmer, a thermostat."""
    wide = 0.15 if kind in ("double", "sockets") else 0.082
    yield rounded("white", (wide, 0.082, 0.01), (0.0, 0.0, -0.003), 0.004, 2)
    for x in (0.0,) if wide < 0.1 else (-0.036, 0.036):
        if kind in ("switch", "double"):
            yield rotate(
                rounded("white", (0.05, 0.056, 0.008), (x, 0.013, 0.003), 0.002, 1), 0, 0.06, (x, 0.041, 0.003)
            )
        elif kind in ("socket", "sockets"):
            yield ring("white", 0.024, 0.005, (x, 0.041, 0.002), 2, 22)
            yield disc("gray", 0.022, 0.001, (x, 0.041, 0.002), 20)
            for s in (-1, 1):
                yield disc("black", 0.0035, 0.002, (x + s * 0.0095, 0.041, 0.0025), 10)
        elif kind == "dimmer":
            yield disc("white", 0.024, 0.02, (0.0, 0.041, 0.001), 26)
            yield box("gray", (0.002, 0.014, 0.001), (0.0, 0.046, 0.021))
        else:
            yield disc("gray", 0.034, 0.018, (0.0, 0.041, 0.001), 28)
            yield disc("screen", 0.028, 0.002, (0.0, 0.041, 0.018), 26)
            yield box("orange", (0.02, 0.008, 0.001), (0.0, 0.037, 0.02))


FAMILIES = (
    Family("switch", "switch", kinds_of(switch, "switch", "double", "dimmer", "thermostat")),
    Family("socket", "switch", kinds_of(switch, "socket", "sockets")),
)
