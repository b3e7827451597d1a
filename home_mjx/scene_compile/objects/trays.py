"""Trays of drawers: bottom, sides and back behind a front, in its compartment."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Float

from home_mjx.datasets.kept_results import find_model
from home_mjx.geometry.meshes import box_triangles, make_model, surface_areas
from home_mjx.geometry.rotations import yaw_matrix
from home_mjx.scene_compile.objects.compartments import Pocket
from home_mjx.scene_compile.objects.doors import LeafPart, PlacedLeaf
from home_mjx.schema.compiled import Model

TRAY_BOARD = 0.01  # [m], thickness of the boards of a tray
TRAY_GAP = 0.003  # [m], gap between a tray and its compartment
TRAY_HEADROOM = 0.01  # [m], gap above it
MIN_OVERLAP = 0.02  # [m], minimum length of a tray that remains in its compartment
MIN_ALIGNMENT = 0.999  # minimum cosine of a drawer's direction and the open side of its compartment


def find_pocket(leaf: LeafPart, pockets: Sequence[Pocket]) -> Pocket | None:
    """Return the compartment behind a sliding front; None if there is none, or if it does not slide straight out."""
    front, travel = leaf.model.box.astype(np.float64).tolist(), leaf.wide_open - leaf.closed
    for pocket in pockets:
        way = pocket.side * travel * leaf.slide[pocket.axis]
        if np.array_equal(pocket.front, front) and way >= MIN_ALIGNMENT * abs(travel) > 0:
            return pocket
    return None


def add_tray(leaf: LeafPart, pocket: Pocket) -> LeafPart:
    """Return a front with the tray that fills its compartment, in its mesh and as boxes.

    Its travel is at most the length of the tray less `MIN_OVERLAP`.
    """
    tray = tray_boxes(pocket)
    length = float(np.ptp(tray[0, :, pocket.axis])) - MIN_OVERLAP
    travel = np.clip(leaf.wide_open - leaf.closed, -length, length)
    model = _with_boxes(leaf.model, tray, pocket.axis)
    return replace(leaf, model=model, board=leaf.model, tray=tray, wide_open=leaf.closed + float(travel))


def tray_boxes(pocket: Pocket) -> Float[np.ndarray, "4 2 3"]:
    """Return the bottom, both sides and the back of a compartment's tray: minimum and maximum corners [m].

    It begins at the back of the front, and ends `TRAY_GAP` before the back of the compartment.
    """
    axis, across, end = pocket.axis, 1 - pocket.axis, (pocket.side + 1) // 2
    outer = pocket.box + TRAY_GAP * np.array([[1.0], [-1.0]])
    outer[1, 2] -= TRAY_HEADROOM
    outer[end, axis] = pocket.front[1 - end][axis]
    boards = np.repeat(outer[None], 4, axis=0)
    boards[0, 1, 2] = boards[1:, 0, 2] = outer[0, 2] + TRAY_BOARD
    boards[1, 1, across] = boards[3, 0, across] = outer[0, across] + TRAY_BOARD
    boards[2, 0, across] = boards[3, 1, across] = outer[1, across] - TRAY_BOARD
    boards[3, end, axis] = outer[1 - end, axis] + pocket.side * TRAY_BOARD
    return boards


def _with_boxes(front: Model, boxes: Float[np.ndarray, "n 2 3"], axis: int) -> Model:
    """Return a front with boxes that look like its largest triangle, whose texture goes on over them."""
    triangles = np.concatenate([box_triangles(low / 2 + high / 2, high / 2 - low / 2) for low, high in boxes])
    row = int(surface_areas(front.triangle.astype(float)).argmax())
    own, across = front.slot == front.slot[row], 1 - axis
    points, uv = front.triangle[own].reshape(-1, 3).astype(float), front.uv[own].reshape(-1, 2).astype(float)
    map_uv = np.linalg.lstsq(np.c_[points[:, [across, 2]], np.ones(len(points))], uv, rcond=None)[0]
    places = np.stack(
        [triangles[..., across] + triangles[..., axis], triangles[..., 2], np.ones(triangles.shape[:2])], -1
    )
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    count = len(triangles)
    return make_model(
        f"{front.key.split(':')[0].rpartition('/')[0]}/drawer",
        np.concatenate([front.triangle, triangles]),
        np.concatenate([front.uv, places @ map_uv]),
        np.concatenate([front.slot, np.full(count, front.slot[row])]),
        np.concatenate([front.part, np.full(count, front.part[row])]),
        np.concatenate([front.normal, np.repeat(normal[:, None], 3, axis=1)]),
        find=find_model,
    )


def tray_columns(leaves: Sequence[PlacedLeaf]) -> dict[str, Float[np.ndarray, "h t 3"]]:
    """Return `tray_pos` and `tray_size` of the table of doors; without boxes if no leaf has a tray."""
    count = max((len(leaf.tray) for leaf in leaves), default=0)
    pos, size = np.zeros((len(leaves), count, 3)), np.full((len(leaves), count, 3), -1.0)
    for row, leaf in enumerate(leaves):
        own = len(leaf.tray)
        pos[row, :own] = (leaf.tray.center - leaf.box.center) @ yaw_matrix(float(leaf.box.yaw[0]))
        size[row, :own] = leaf.tray.half
    return {"tray_pos": pos, "tray_size": size}
