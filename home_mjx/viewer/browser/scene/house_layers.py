"""Layers of a house in the 3D scene that are drawn when they are first shown: distances to the goal, and object ids."""

from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Float, UInt8

from home_mjx.bank.bank import HouseBank
from home_mjx.scene_compile import decode_row
from home_mjx.schema.compiled import ARCHITECTURE
from home_mjx.tasks.rules.cell_graph import CellGraph
from home_mjx.viewer.episodes.goal_markers import GoalMarkers
from home_mjx.viewer.episodes.state_report import find_goal_cells

if TYPE_CHECKING:
    import viser

LIFT = 0.05  # [m], of points above the floor
NEAR, FAR = np.array([60.0, 200.0, 110.0]), np.array([200.0, 60.0, 160.0])  # colours next to the goal, and farthest
BAND = 1.0  # [m], width of the bands of equal brightness
FONT_HEIGHT = 0.1  # [m], of ids


def distance_points(
    bank: HouseBank, house: int, goals: GoalMarkers
) -> tuple[Float[np.ndarray, "n 3"], Float[np.ndarray, " n"]]:
    """Return the centres of a house's cells from which a path leads to the goal, and the paths' lengths [m]."""
    graph = CellGraph(bank, house, brush_cost_factor=1.0)
    ends = find_goal_cells(graph, goals)
    if ends is None:
        return np.zeros((0, 3)), np.zeros(0)
    distance = graph.compute_distances([ends])[:, 0]
    is_known = np.isfinite(distance)
    return graph.place[is_known], distance[is_known]


def colour_distances(distance: Float[np.ndarray, " n"]) -> UInt8[np.ndarray, "n 3"]:
    """Return colours from `NEAR` to `FAR`, every second `BAND` darker.

    Example:
        >>> colour_distances(np.array([0.0, 1.5, 2.0])).tolist()
        [[60, 200, 110], [99, 57, 88], [200, 60, 160]]
    """
    share = (distance / max(distance.max(initial=0.0), 1e-6))[:, None]
    dark = np.where(np.floor(distance / BAND) % 2 == 1, 0.6, 1.0)[:, None]
    return (dark * (NEAR + share * (FAR - NEAR))).round().astype(np.uint8)


def draw_distances(server: "viser.ViserServer", bank: HouseBank, house: int, goals: GoalMarkers) -> Any:
    """Draw the cells of a house in the colours of their distances to the goal; return the handle."""
    points, distance = distance_points(bank, house, goals)
    lifted = (points + np.array([0.0, 0.0, LIFT])).astype(np.float32)
    size = float(bank.spec.cell) / 3
    return server.scene.add_point_cloud("/overlays/distances", lifted, colour_distances(distance), point_size=size)


def draw_ids(server: "viser.ViserServer", bank: HouseBank, house: int, boxes: Float[np.ndarray, "i 2 3"]) -> list[Any]:
    """Draw object id and category above each object of a house; return the handles.

    Args:
        server: viser's server.
        bank: The houses.
        house: Index of the house.
        boxes: Bounds of all instances [m].
    """
    model, ids = (np.asarray(x[house]) for x in (bank.geometry.instance_model, bank.geometry.instance_object))
    shown = np.flatnonzero((model >= 0) & (np.arange(len(model)) > ARCHITECTURE) & (ids >= 0))
    rows = np.asarray(bank.semantics)[np.asarray(bank.geometry.instance_semantic[house])]
    return [
        server.scene.add_label(
            f"/overlays/ids/{number}",
            f"{ids[number]} {decode_row(rows[number]).get('fine', 'object')}",
            position=(*boxes[number].mean(axis=0)[:2].tolist(), float(boxes[number, 1, 2])),
            font_size_mode="scene",
            font_scene_height=FONT_HEIGHT,
            anchor="bottom-center",
        )
        for number in shown.tolist()
    ]
