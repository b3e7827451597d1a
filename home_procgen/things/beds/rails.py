"""Side rails and mattress length of beds."""

from collections.abc import Iterator

from home_procgen.primitives.solids import Solid, box
from home_procgen.shapes.groups import add_mirror_images
from home_procgen.shapes.rounded import rounded_box

MATTRESS_LENGTH = 2.0  # [m], length of a mattress


def rails(width: float, low: float, high: float, slot: str = "wood") -> Iterator[Solid]:
    """Build a frame around the mattress and its base board."""
    z = MATTRESS_LENGTH / 2 + 0.02
    yield from add_mirror_images(
        [rounded_box(slot, (0.035, high - low, 2 * z + 0.03), (width / 2 + 0.02, low, 0.0), 0.008, 1)]
    )
    yield rounded_box(slot, (width + 0.07, high - low, 0.035), (0.0, low, z), 0.008, 1)
    yield box(slot, (width, 0.03, 2 * z - 0.01), (0.0, high - 0.08, 0.0))
