"""HTML of a house as read, for notebooks: counts, rooms, and the plan of each level as SVG (host only)."""

from collections.abc import Mapping, Sequence
from html import escape

import numpy as np
from jaxtyping import Float

PLAN_SIDE = 180  # [px], longest side of a plan
COLOURS = ("#e7c9a9", "#accdb7", "#a8c0de", "#e0b2b2", "#cdbadc", "#deda9f")  # of rooms, in turn


def format_house(name: str, rows: Mapping[str, object], levels: Sequence[Sequence[Float[np.ndarray, "_ 3 2"]]]) -> str:
    """Return a table of a house, and the plan of each level.

    Args:
        name: Id of the house.
        rows: Values by name.
        levels: Corners of the floors' triangles in plan, see `format_floors`, of each level.
    """
    cells = "".join(f"<tr><td>{escape(key)}</td><td>{escape(str(value))}</td></tr>" for key, value in rows.items())
    plans = (format_floors(floors, f"level {number}") for number, floors in enumerate(levels))
    return f"<b>House {escape(name)}</b><table>{cells}</table>{''.join(plans)}"


def format_floors(floors: Sequence[Float[np.ndarray, "_ 3 2"]], caption: str) -> str:
    """Return a plan from the triangles of floors, each floor in a colour; "" without floors.

    Args:
        floors: Corners of each floor's triangles in plan, x to the right and y up [m].
        caption: Text below the plan.

    Example:
        >>> format_floors([np.array([[[0.0, 0.0], [2.0, 0.0], [0.0, 1.0]]])], "level 0").split('"')[5]
        '90'
    """
    corners = np.concatenate([floor.reshape(-1, 2) for floor in floors] or [np.zeros((0, 2))])
    if not len(corners):
        return ""
    low, size = corners.min(axis=0), np.maximum(np.ptp(corners, axis=0), 1e-6)
    scale = PLAN_SIDE / size.max()
    paths = [
        f'<path fill="{COLOURS[n % len(COLOURS)]}" d="{_path(floor)}"/>'
        for n, floor in enumerate(((floor - low) * [1, -1] + [0, size[1]]) * scale for floor in floors)
    ]
    drawing = f'<svg width="{size[0] * scale:.0f}" height="{size[1] * scale:.0f}">{"".join(paths)}</svg>'
    return f'<span style="display:inline-block;margin:4px">{drawing}<br>{escape(caption)}</span>'


def _path(corners: Float[np.ndarray, "f 3 2"]) -> str:
    """Return triangles as the data of an SVG path."""
    return "".join(f"M{'L'.join(f'{x:.1f} {y:.1f}' for x, y in triangle)}Z" for triangle in corners.tolist())
