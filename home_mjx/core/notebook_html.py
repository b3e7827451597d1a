"""HTML of values in notebooks: tables, plans and curves, inline as text, PNG and SVG (host only)."""

import base64
import io
from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

import numpy as np
from jaxtyping import Float, Int

COLOURS = ("#e0a458", "#4caf72", "#5a96fa", "#d9534f", "#b07cd8", "#4ec9c9")
MAX_PLANS = 4  # houses whose plans are shown
PLAN_SIDE = 180  # [px], longest side of a plan
MAX_CURVE_POINTS = 600
ROOM_PALETTE = np.array(
    [[231, 201, 169], [172, 205, 183], [168, 192, 222], [224, 178, 178], [205, 186, 220], [222, 218, 160]], np.uint8
)


def format_table(title: str, rows: Mapping[str, Any]) -> str:
    """Return a title and a table of names and values.

    Example:
        >>> format_table("Bank", {"houses": 2})
        '<b>Bank</b><table><tr><td>houses</td><td>2</td></tr></table>'
    """
    cells = "".join(f"<tr><td>{escape(name)}</td><td>{escape(str(value))}</td></tr>" for name, value in rows.items())
    return f"<b>{escape(title)}</b><table>{cells}</table>"


def format_plan(rooms: Int[np.ndarray, "rows columns"], caption: str) -> str:
    """Return the plan of a storey as an image: each room in a colour, north (+y) up; "" if it has no room.

    Args:
        rooms: Room of each cell, the first row in the south; -1 none.
        caption: Text below the plan.
    """
    inside = np.argwhere(rooms >= 0)
    if not len(inside):
        return ""
    (top, left), (bottom, right) = inside.min(axis=0), inside.max(axis=0) + 1
    part = rooms[top:bottom, left:right][::-1]
    image = np.where(part[..., None] >= 0, ROOM_PALETTE[part % len(ROOM_PALETTE)], np.uint8(255))
    scale = PLAN_SIDE / max(part.shape)
    size = f'width="{part.shape[1] * scale:.0f}" height="{part.shape[0] * scale:.0f}"'
    style = "image-rendering:pixelated"
    figure = f'<img {size} style="{style}" src="data:image/png;base64,{_png(image)}">'
    return f'<span style="display:inline-block;margin:4px">{figure}<br>{escape(caption)}</span>'


def format_houses(
    names: Sequence[str],
    rooms: Int[np.ndarray, "h rows columns"],
    num_instances: Int[np.ndarray, " h"],
    area: Float[np.ndarray, " h"],
    bakes: Sequence[str],
) -> str:
    """Return counts of a bank's houses, and the plans of the first ones.

    Args:
        names: Ids of the houses.
        rooms: Room of each cell of the lowest storeys; -1 none.
        num_instances: Number of instances of each house.
        area: Walkable area of each house [m^2].
        bakes: Names of baked records.
    """
    first = rooms[:MAX_PLANS]
    counts = {
        "houses": len(names),
        "instances of a house": f"{num_instances.mean():.0f}",
        "rooms of the first storey": ", ".join(str(len(np.unique(plan[plan >= 0]))) for plan in first),
        "walkable area": f"{area.mean():.0f} m² a house",
        "bakes": ", ".join(bakes) or "none",
    }
    plans = (format_plan(plan, name) for plan, name in zip(first, names, strict=False))
    return format_table("HouseBank", counts) + "".join(plans)


def format_curves(
    title: str, x: Float[np.ndarray, " n"], curves: Mapping[str, Float[np.ndarray, " n"]], size: tuple[int, int]
) -> str:
    """Return curves over x as SVG, with the limits of both axes; values that are not finite are left out.

    Args:
        title: Text above the curves, with the units of both axes.
        x: Positions on the horizontal axis.
        curves: Values by name.
        size: Width and height [px].
    """
    finite = np.concatenate([y[np.isfinite(y)] for y in curves.values()] or [np.zeros(1)])
    low, high = (float(finite.min()), float(finite.max())) if len(finite) else (0.0, 1.0)
    lines = [_polyline(x, y, (low, high), size, COLOURS[n % len(COLOURS)]) for n, y in enumerate(curves.values())]
    names = "".join(
        f' <span style="color:{COLOURS[n % len(COLOURS)]}">{escape(name)}</span>' for n, name in enumerate(curves)
    )
    frame = f'<rect width="{size[0]}" height="{size[1]}" fill="none" stroke="#888"/>'
    drawing = f'<svg width="{size[0]}" height="{size[1]}">{frame}{"".join(lines)}</svg>'
    limits = f"x {x[0]:.4g} to {x[-1]:.4g}, y {low:.4g} to {high:.4g}" if len(x) else "no value"
    return f"<div><b>{escape(title)}</b>{names}<br>{drawing}<br>{limits}</div>"


def _polyline(
    x: Float[np.ndarray, " n"],
    y: Float[np.ndarray, " n"],
    limits: tuple[float, float],
    size: Sequence[int],
    colour: str,
) -> str:
    """Return one curve, thinned to `MAX_CURVE_POINTS`."""
    known = np.flatnonzero(np.isfinite(y))
    known = known[:: max(len(known) // MAX_CURVE_POINTS, 1)]
    across = (x[known] - x[0]) / max(x[-1] - x[0], 1e-12) if len(x) else x
    up = (y[known] - limits[0]) / max(limits[1] - limits[0], 1e-12)
    points = " ".join(f"{a * size[0]:.1f},{(1 - b) * size[1]:.1f}" for a, b in zip(across, up, strict=True))
    return f'<polyline points="{points}" fill="none" stroke="{colour}"/>'


def _png(image: np.ndarray) -> str:
    """Return an image as a PNG in base64."""
    from PIL import Image

    data = io.BytesIO()
    Image.fromarray(image).save(data, "PNG", optimize=True)
    return base64.b64encode(data.getvalue()).decode()
