"""Railings of balconies, terraces and stairwells."""

from collections.abc import Iterator

from home_procgen.primitives.family import VariantFamily, make_slots, make_variant
from home_procgen.primitives.solids import Solid, box

RAILING_HEIGHT = 1.0  # [m], of a railing
RAILING_DEPTH = 0.05  # [m], thickness of a railing


def railing(length: float, boards: bool) -> Iterator[Solid]:
    """Generate the solids of a straight railing along x on posts.

    Args:
        length: Length [m].
        boards: Horizontal boards instead of vertical bars.
    """
    yield box("wood", (length, 0.05, RAILING_DEPTH), (0.0, RAILING_HEIGHT - 0.05, 0.0))
    posts = max(round(length / 1.2), 1)
    for i in range(posts + 1):
        yield box("chrome", (0.04, RAILING_HEIGHT - 0.05, 0.04), ((i / posts - 0.5) * (length - 0.04), 0.0, 0.0))
    if boards:
        for k in range(5):
            yield box("wood", (length - 0.02, 0.12, 0.02), (0.0, 0.1 + 0.165 * k, 0.025 - 0.01))
        return
    yield box("chrome", (length, 0.03, 0.03), (0.0, 0.08, 0.0))
    bars = round(length / 0.12)
    for i in range(1, bars):
        yield box("chrome", (0.014, RAILING_HEIGHT - 0.16, 0.014), ((i / bars - 0.5) * length, 0.11, 0.0))


RAILING_LENGTHS = (1.0, 1.5, 2.2, 3.2, 4.5)  # [m], of the railing models
FAMILIES = (
    VariantFamily(
        "railing",
        "fence",
        railing,
        make_slots("wood", "chrome"),
        tuple(make_variant(length=length, boards=boards) for boards in (False, True) for length in RAILING_LENGTHS),
        centred=False,
    ),
)
