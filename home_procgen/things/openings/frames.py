"""Door and window frames and their dimensions."""

from collections.abc import Iterator

from home_procgen.primitives.solids import Solid, box

JAMB_WIDTH = 0.05  # [m], width of a door's frame posts

FRAME_DEPTH = 0.14  # [m], depth of a frame


def frame(width: float, height: float, slot: str = "wood", trim: bool = True) -> Iterator[Solid]:
    """Build posts and a lintel around an opening."""
    for s in (-1, 1):
        yield box(slot, (JAMB_WIDTH, height, FRAME_DEPTH), (s * (width - JAMB_WIDTH) / 2, 0.0, 0.0))
        if trim:
            for z in (-1, 1):
                yield box(
                    slot,
                    (JAMB_WIDTH - 0.004, height - 0.002, 0.012),
                    (s * (width - JAMB_WIDTH) / 2, 0.0, z * (FRAME_DEPTH / 2 + 0.004)),
                )
    yield box(slot, (width - 2 * JAMB_WIDTH, JAMB_WIDTH, FRAME_DEPTH), (0.0, height - JAMB_WIDTH, 0.0))
