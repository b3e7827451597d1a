"""Door and window frames and their dimensions."""

from collections.abc import Iterator

from home_procgen.primitives.solids import Solid, box

JAMB = 0.05  # [m], width of a door's frame posts

DEEP = 0.14  # [m], depth of a frame


def frame(width: float, height: float, slot: str = "wood", trim: bool = True) -> Iterator[Solid]:
    """Build posts and a lintel around an opening."""
    for s in (-1, 1):
        yield box(slot, (JAMB, height, DEEP), (s * (width - JAMB) / 2, 0.0, 0.0))
        if trim:
            for z in (-1, 1):
                yield box(
                    slot, (JAMB - 0.004, height - 0.002, 0.012), (s * (width - JAMB) / 2, 0.0, z * (DEEP / 2 + 0.004))
                )
    yield box(slot, (width - 2 * JAMB, JAMB, DEEP), (0.0, height - JAMB, 0.0))
