"""What kitchen cabinets share: bodies and worktops."""

from collections.abc import Iterator

from home_procgen.primitives.solids import Solid, box
from home_procgen.shapes.rounded import rounded

DEPTH = 0.6  # [m]

WORKTOP = 0.88  # [m]

FACE = DEPTH / 2 - 0.04  # [m], where fronts begin


def body(width: float, low: float = 0.1) -> Iterator[Solid]:
    """A cabinet's plinth and what stands on it."""
    yield box("black", (width, low, DEPTH - 0.12), (0.0, 0.0, -0.05))
    yield box("paint", (width, WORKTOP - 0.04 - low, DEPTH - 0.04), (0.0, low, -0.02))


def worktop(width: float, slot: str = "stone") -> Solid:
    """The slab on a cabinet."""
    return rounded(slot, (width, 0.04, DEPTH), (0.0, WORKTOP - 0.04, 0.0), 0.008, 2)
