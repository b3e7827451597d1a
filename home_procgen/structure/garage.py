"""Garage doors: always closed, placed in the wall like windows."""

from collections.abc import Iterator

from home_procgen.primitives.family import VariantFamily, make_slots, make_variant
from home_procgen.primitives.solids import Solid, box, cushion


def garage_door(width: float, height: float, panels: int) -> Iterator[Solid]:
    """Generate the solids of a sectional door in its frame.

    Args:
        width: Width over the frame [m].
        height: Height over the frame [m].
        panels: Number of sections, one above the other.
    """
    rim = 0.08
    for side in (-1, 1):
        yield box("color", (rim, height, 0.13), (side * (width - rim) / 2, 0.0, 0.0))
    yield box("color", (width - 2 * rim, rim, 0.13), (0.0, height - rim, 0.0))
    high = (height - rim) / panels
    for i in range(panels):
        yield box("steel", (width - 2 * rim, high - 0.008, 0.03), (0.0, i * high, 0.0))
        for k in range(4):
            wide = (width - 2 * rim) / 4
            at = ((k - 1.5) * wide, i * high + 0.08, 0.0)
            yield cushion("steel", (wide - 0.12, high - 0.16, 0.046), at, 0.008)
    yield box("chrome", (0.14, 0.03, 0.05), (0.0, 0.9, 0.03))


FAMILIES = (
    VariantFamily(
        "garage_door",
        "garage_door",
        garage_door,
        make_slots("color", "steel", "chrome"),
        (make_variant(width=2.5, height=2.15, panels=4), make_variant(width=3.0, height=2.15, panels=5)),
        centred=False,
    ),
)
