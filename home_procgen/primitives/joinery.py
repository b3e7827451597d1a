"""Pieces that many designs share: legs, panels with handles, open cases."""

from collections.abc import Iterator

from home_procgen.primitives.solids import Solid, box, cylinder

BOARD_THICKNESS = 0.02  # [m], thickness of boards and doors


def make_legs(
    material: str, width: float, depth: float, height: float, thickness: float = 0.05, turned: bool = False
) -> Iterator[Solid]:
    """Generate four legs on y = 0, whose outer sides span width (x) by depth (z) [m]; `turned`: round, tapering."""
    for x in (-1, 1):
        for z in (-1, 1):
            at = (x * (width - thickness) / 2, 0.0, z * (depth - thickness) / 2)
            if turned:
                yield cylinder(material, 0.3 * thickness, height, at, top=thickness / 2, sides=8)
            else:
                yield box(material, (thickness, height, thickness), at)


def make_fronts(
    material: str,
    handle: str,
    width: float,
    height: float,
    bottom: float,
    front: float,
    columns: int = 1,
    rows: int = 1,
    upright: bool = True,
) -> Iterator[Solid]:
    """Generate doors or drawers that cover width x height from `bottom` up, with their faces at z = `front`.

    Args:
        material: Slot of the panels.
        handle: Slot of the handles.
        width: Total width [m].
        height: Total height [m].
        bottom: Height of the lower edge [m].
        front: z of the panels' outer face [m].
        columns: Panels side by side.
        rows: Panels above one another.
        upright: Door handles at the edge away from the hinge; else drawer handles in the middle.
    """
    wide, high, gap = width / columns, height / rows, 0.006
    for column in range(columns):
        x = -width / 2 + (column + 0.5) * wide
        side = 1 if column < columns / 2 else -1
        for row in range(rows):
            y = bottom + row * high
            yield box(
                material, (wide - gap, high - gap, BOARD_THICKNESS), (x, y + gap / 2, front - BOARD_THICKNESS / 2)
            )
            if upright:
                length = min(0.18, high / 3)
                at = (x + side * (wide / 2 - 0.04), y + high / 2 - length / 2, front + 0.012)
                yield box(handle, (0.014, length, 0.024), at)
            else:
                yield box(handle, (min(0.16, wide / 2), 0.014, 0.024), (x, y + high / 2, front + 0.012))


def make_case(
    material: str, width: float, height: float, depth: float, shelves: int, columns: int = 1, back: bool = True
) -> Iterator[Solid]:
    """Generate an open case of boards on y = 0 [m]: sides, uprights, `shelves` besides bottom and top, and a back."""
    for column in range(columns + 1):
        x = -width / 2 + BOARD_THICKNESS / 2 + column * (width - BOARD_THICKNESS) / columns
        yield box(material, (BOARD_THICKNESS, height, depth), (x, 0.0, 0.0))
    inner, lift = width - 2 * BOARD_THICKNESS, 0.04
    for level in range(shelves + 2):
        y = lift + level * (height - lift - BOARD_THICKNESS) / (shelves + 1)
        yield box(material, (inner, BOARD_THICKNESS, depth - 0.01), (0.0, y, 0.005))
    if back:
        yield box(material, (inner, height - lift, 0.01), (0.0, lift, -depth / 2 + 0.005))
