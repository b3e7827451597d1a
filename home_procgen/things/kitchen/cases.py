"""Bodies and worktops of kitchen cabinets."""

from collections.abc import Iterator

from home_procgen.primitives.solids import Solid, box
from home_procgen.shapes.rounded import rounded_box

BASE_DEPTH = 0.6  # [m], depth of base cabinets

WORKTOP_HEIGHT = 0.88  # [m], height of the worktop's upper surface

FRONT_Z = BASE_DEPTH / 2 - 0.04  # [m], z of the back of fronts


def base_body(width: float, low: float = 0.1) -> Iterator[Solid]:
    """Build the plinth and body of a base cabinet."""
    yield box("black", (width, low, BASE_DEPTH - 0.12), (0.0, 0.0, -0.05))
    yield box("paint", (width, WORKTOP_HEIGHT - 0.04 - low, BASE_DEPTH - 0.04), (0.0, low, -0.02))


def worktop(width: float, slot: str = "stone") -> Solid:
    """Build the worktop slab of a cabinet."""
    return rounded_box(slot, (width, 0.04, BASE_DEPTH), (0.0, WORKTOP_HEIGHT - 0.04, 0.0), 0.008, 2)
