"""Range hoods."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, box, cylinder
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import join_loops, rounded_box
from home_procgen.shapes.sweep import beam, prism, ring, rod
from home_procgen.things.family import FurnitureFamily, design
from home_procgen.things.joinery import disc, front

HOOD_HEIGHTS = (0.85, 1.05, 1.25)  # [m], from the undersides of hoods to the ceilings that their shafts reach


def _chimney(width: float, top: float) -> Iterator[Solid]:
    yield rounded_box("steel", (width, 0.06, 0.48), (0.0, 0.0, 0.0), 0.006, 1)
    slope = [(-0.24, 0.0), (0.24, 0.0), (0.02, 0.22), (-0.24, 0.22)]
    yield prism("steel", slope, width - 0.1, (0.0, 0.06, 0.0), "side")
    yield rounded_box("steel", (0.28, top - 0.27, 0.26), (0.0, 0.27, -0.11), 0.004, 1)
    yield from _switches(0.0, 0.03, 0.24)


def _glass(width: float, top: float) -> Iterator[Solid]:
    yield prism(
        "glass",
        [(width / 2 * np.cos(a), -0.24 + 0.48 * np.sin(a)) for a in np.linspace(0, np.pi, 16)],
        0.012,
        (0.0, 0.04, 0.0),
        "top",
    )
    yield rounded_box("steel", (width - 0.12, 0.05, 0.3), (0.0, 0.0, -0.09), 0.008, 1)
    yield cylinder("steel", 0.12, top - 0.05, (0.0, 0.05, -0.12), sides=20)


def _slanted(width: float, top: float) -> Iterator[Solid]:
    plate = [(-0.2, 0.0), (-0.16, 0.0), (0.2, 0.48), (0.2, 0.52), (-0.2, 0.52)]
    yield prism("black", plate, width, (0.0, 0.0, 0.0), "side")
    yield beam("screen", (0.0, 0.05, -0.115), (0.0, 0.45, 0.185), width - 0.05, 0.012)
    yield rounded_box("black", (0.26, top - 0.5, 0.22), (0.0, 0.5, -0.09), 0.004, 1)
    yield from _switches(0.0, 0.5, 0.2)


def _box(width: float, top: float) -> Iterator[Solid]:
    yield rounded_box("steel", (width, 0.13, 0.46), (0.0, 0.0, 0.0), 0.012, 1)
    yield box("black", (width - 0.06, 0.006, 0.3), (0.0, -0.004, 0.02))
    yield rounded_box("chrome", (0.3, 0.03, 0.02), (0.0, 0.05, 0.235), 0.008, 2)
    yield box("steel", (0.22, top - 0.13, 0.2), (0.0, 0.13, -0.12))
    yield from _switches(0.0, 0.065, 0.242)


def _mantel(width: float, top: float) -> Iterator[Solid]:
    yield prism(
        "paint",
        [(-0.25, 0.0), (0.25, 0.0), (0.24, 0.12), (-0.02, 0.5), (-0.02, top), (-0.25, top)],
        width,
        (0.0, 0.0, 0.0),
        "side",
    )
    yield rounded_box("wood", (width + 0.04, 0.05, 0.54), (0.0, 0.02, 0.0), 0.012, 1)
    yield rounded_box("wood", (width + 0.02, 0.04, 0.28), (0.0, 0.5, -0.11), 0.012, 1)
    for i in range(5):
        yield rod("chrome", ((i - 2) * 0.16, 0.045, 0.27), ((i - 2) * 0.16, 0.045, 0.3), 0.006)


def _drum(width: float, top: float) -> Iterator[Solid]:
    """Build a steel drum hood with a ring of light below."""
    yield revolve("steel", [(0.17, 0.0), (0.18, 0.02), (0.18, top - 0.02), (0.17, top)], sides=28, steps=1)
    yield ring("bulb", 0.13, 0.02, (0.0, -0.002, 0.0), 1, 24)
    yield rounded_box("steel", (0.12, 0.6, 0.03), (0.0, 0.06, -0.185), 0.006, 1)
    yield from _switches(0.0, 0.05, 0.176)


def _slab(width: float, top: float) -> Iterator[Solid]:
    """Build a flat slab under a slim shaft, T-shaped."""
    yield rounded_box("steel", (width + 0.1, 0.045, 0.46), (0.0, 0.0, 0.0), 0.008, 2)
    yield box("black", (width - 0.04, 0.004, 0.32), (0.0, -0.003, 0.02))
    yield rounded_box("steel", (0.2, top - 0.245, 0.2), (0.0, 0.045, -0.13), 0.006, 1)
    yield box("steel", (0.18, 0.2, 0.18), (0.0, top - 0.2, -0.13))
    for s in (-1, 1):
        yield disc("bulb", 0.03, 0.004, (s * 0.22, 0.022, 0.228), 16)


def _pyramid(width: float, top: float) -> Iterator[Solid]:
    """Build a hood of four sloping sides with a rim, and a shaft."""
    rim = fillet([(x * width / 2, z * 0.24) for x, z in ((-1, -1), (1, -1), (1, 1), (-1, 1))], 0.01, 1, True)
    loops = []
    for share, y in ((1.0, 0.0), (1.0, 0.05), (0.94, 0.06), (0.36, 0.34), (0.36, 0.36)):
        loops.append(np.array([(share * x, y, share * (z + 0.24) - 0.24) for x, z in rim]))
    yield join_loops("steel", loops)
    yield rounded_box("steel", (0.2, top - 0.36, 0.16), (0.0, 0.36, -0.155), 0.004, 1)
    yield rod("chrome", (-width / 2 + 0.04, 0.03, 0.25), (width / 2 - 0.04, 0.03, 0.25), 0.006)
    for s in (-1, 1):
        yield rod("chrome", (s * (width / 2 - 0.06), 0.03, 0.235), (s * (width / 2 - 0.06), 0.03, 0.25), 0.005)


def _visor(width: float, top: float) -> Iterator[Solid]:
    """Build a slim hood with a pull-out glass visor below a cupboard."""
    yield rounded_box("paint", (width, 0.4, 0.3), (0.0, 0.04, -0.08), 0.006, 1)
    yield box("steel", (0.22, top - 0.44, 0.2), (0.0, 0.44, -0.12))
    yield from front(
        "paint",
        (width - 0.006, 0.39),
        (0.003 - width / 2, 0.045, 0.07),
        "shaker",
        ("chrome", "knob", 0.9, 0.12),
        opens="left",
    )
    yield rounded_box("steel", (width, 0.035, 0.32), (0.0, 0.0, -0.07), 0.005, 1)
    yield rounded_box("glass", (width - 0.02, 0.012, 0.16), (0.0, 0.01, 0.16), 0.004, 1)
    yield rounded_box("steel", (width, 0.035, 0.02), (0.0, 0.0, 0.245), 0.006, 1)


def _dome(width: float, top: float) -> Iterator[Solid]:
    """Build a hammered metal dome with bands, and a pipe."""
    ring_of = [(np.cos(a), np.sin(a)) for a in np.linspace(0, 2 * np.pi, 28, endpoint=False)]
    shape = ((1.0, 0.0), (1.0, 0.03), (0.94, 0.1), (0.8, 0.19), (0.55, 0.29), (0.34, 0.36), (0.3, 0.4))
    yield join_loops("brass", [np.array([(r * 0.42 * x, y, r * 0.24 * z) for x, z in ring_of]) for r, y in shape])
    yield cylinder("brass", 0.075, top - 0.38, (0.0, 0.38, 0.0), sides=20)
    for y in (0.4, 0.62):
        yield cylinder("brass", 0.082, 0.02, (0.0, y, 0.0), sides=20)
    yield rounded_box("iron", (0.1, 0.6, 0.02), (0.0, 0.2, -0.23), 0.004, 1)
    for y in (0.45, 0.7):
        yield rod("iron", (0.0, y, -0.22), (0.0, y, -0.06), 0.012)


_HOOD_KINDS = {
    "chimney": _chimney, "glass": _glass, "slanted": _slanted, "box": _box, "mantel": _mantel, "drum": _drum,
    "slab": _slab, "pyramid": _pyramid, "visor": _visor, "dome": _dome,
}  # fmt: skip


def hood(width: float = 0.6, kind: str = "chimney", top: float = HOOD_HEIGHTS[0]) -> Iterator[Solid]:
    """Build a range hood above a cooker, with a shaft or pipe up to the ceiling at `top` metres above its underside."""
    yield from _HOOD_KINDS[kind](width, top)


def _switches(x: float, y: float, z: float) -> Iterator[Solid]:
    for i in range(4):
        yield disc("chrome", 0.01, 0.01, (x + 0.04 * (i - 1.5), y, z), 12)


HOODS = tuple(
    design(hood, kind=kind, width=0.9 if kind == "mantel" else 0.6, top=top)
    for top in HOOD_HEIGHTS
    for kind in _HOOD_KINDS
)


FAMILIES = (FurnitureFamily("range_hood", "range_hood", HOODS),)
