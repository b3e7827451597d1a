"""Kitchen taps."""

from collections.abc import Iterator

from home_procgen.primitives.solids import Solid, cylinder
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.rounded import rounded_box
from home_procgen.shapes.sweep import rod, tube


def tap(x: float, y: float, z: float, kind: str = "arc") -> Iterator[Solid]:
    """Build a mixer tap with its spout towards +z."""
    if kind == "arc":
        path = fillet([(x, y, z), (x, y + 0.3, z), (x, y + 0.3, z + 0.17), (x, y + 0.2, z + 0.18)], 0.09, 6)
        yield tube("chrome", path, 0.011)
        yield cylinder("chrome", 0.022, 0.05, (x, y, z), sides=14)
        yield rod("chrome", (x + 0.02, y + 0.04, z), (x + 0.075, y + 0.06, z), 0.006)
    elif kind == "bridge":
        for s in (-1, 1):
            yield cylinder("brass", 0.016, 0.06, (x + s * 0.09, y, z), sides=12)
            for a in range(2):
                dx, dz = (0.03, 0.0) if a else (0.0, 0.03)
                yield rod(
                    "brass", (x + s * 0.09 - dx, y + 0.075, z - dz), (x + s * 0.09 + dx, y + 0.075, z + dz), 0.006
                )
        yield rod("brass", (x - 0.09, y + 0.05, z), (x + 0.09, y + 0.05, z), 0.011)
        yield tube(
            "brass",
            fillet([(x, y + 0.05, z), (x, y + 0.22, z), (x, y + 0.22, z + 0.16), (x, y + 0.15, z + 0.16)], 0.07, 5),
            0.011,
        )
    else:
        yield cylinder("chrome", 0.02, 0.13, (x, y, z), sides=14)
        yield rounded_box("chrome", (0.03, 0.022, 0.15), (x, y + 0.09, z + 0.06), 0.008, 1)
        yield rounded_box("chrome", (0.02, 0.012, 0.09), (x, y + 0.132, z + 0.02), 0.005, 1)
