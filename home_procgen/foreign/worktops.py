"""Worktops on cabinets, in one run, around a corner or around two."""

from collections.abc import Iterator

from home_procgen.primitives.solids import Solid, box, move, rotate

RUN_DEPTH = 0.61  # [m], depth of a run of cabinets
TOP_THICKNESS, PLINTH_HEIGHT, PLINTH_INSET = 0.04, 0.1, 0.06  # [m]
FRONT_WIDTH, GAP, FRONT_THICKNESS = 0.6, 0.006, 0.018  # [m], of the fronts of cabinets
SIDE_RUNS = {"I": (), "L": (-1,), "C": (-1, 1)}  # sides, in the direction of x, with a run towards the front


def worktop(shape: str, width: float, height: float, depth: float) -> Iterator[Solid]:
    """Generate a worktop; its back is towards -z, its front towards +z.

    Args:
        shape: `I`: one run; `L`: also along the side at -x; `C`: also along both sides; others count as `I`.
        width: Extent along x [m].
        height: Height of the top [m].
        depth: Extent along z [m].
    """
    sides = SIDE_RUNS.get(shape, ())
    run = min(RUN_DEPTH, depth) if sides else depth
    yield from (move(piece, (0.0, 0.0, (run - depth) / 2)) for piece in _run(width, height, run))
    for side in sides:
        turned = (rotate(piece, 1, -side * 1.5707963267948966) for piece in _run(depth - run, height, RUN_DEPTH))
        yield from (move(piece, (side * (width - RUN_DEPTH) / 2, 0.0, run / 2)) for piece in turned)


def _run(width: float, height: float, depth: float) -> Iterator[Solid]:
    """Generate a straight run with fronts towards +z, around x = z = 0."""
    body = height - TOP_THICKNESS
    yield box("stone", (width, TOP_THICKNESS, depth), (0.0, body, 0.0))
    yield box("paint", (width, body - PLINTH_HEIGHT, depth - 2 * FRONT_THICKNESS), (0.0, PLINTH_HEIGHT, 0.0))
    yield box("paint", (width, PLINTH_HEIGHT, depth - 2 * PLINTH_INSET))
    count = max(round(width / FRONT_WIDTH), 1)
    pitch = width / count
    for i in range(count):
        at = (-width / 2 + (i + 0.5) * pitch, PLINTH_HEIGHT + GAP, depth / 2 - FRONT_THICKNESS)
        yield box("paint", (pitch - GAP, body - PLINTH_HEIGHT - 2 * GAP, FRONT_THICKNESS), at)
