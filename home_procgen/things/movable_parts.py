"""Movable parts of furniture: marks on solids, and the joints that a model gets from them."""

from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np
from jaxtyping import Int

from home_mjx.datasets.suncg.write.obj import face_order
from home_mjx.schema.house import Joint, Mesh
from home_procgen.primitives.solids import MovablePart, Solid, Vector

QUARTER_TURN = np.pi / 2
TIP_OUT_ANGLE = 1.0  # [rad], range of tip-out fronts
LID_ANGLE = 1.3  # [rad], range of lids
# Hinged edge of a front towards +z, or the travel of a drawer [m]; `tips`: lower edge, range `TIP_OUT_ANGLE`.
OpeningMotion = Literal["left", "right", "bottom", "top", "tips"] | float
_HINGES = {
    "left": ("door", (0.0, -1.0, 0.0), (0.0, 0.0), QUARTER_TURN),
    "right": ("door", (0.0, 1.0, 0.0), (1.0, 0.0), QUARTER_TURN),
    "bottom": ("door", (1.0, 0.0, 0.0), (0.0, 0.0), QUARTER_TURN),
    "top": ("flap", (-1.0, 0.0, 0.0), (0.0, 1.0), QUARTER_TURN),
    "tips": ("flap", (1.0, 0.0, 0.0), (0.0, 0.0), TIP_OUT_ANGLE),
}


def front_part(opens: OpeningMotion, corner: Vector, size: tuple[float, float]) -> MovablePart:
    """Return the part of a front towards +z, hinged at an outer edge so that it clears its neighbours.

    Args:
        opens: Hinged edge, or the distance a drawer slides out [m].
        corner: Lower left corner of the outer face [m].
        size: Width and height [m].

    Example:
        >>> front_part("right", (0.0, 0.0, 0.3), (0.5, 2.0)).point
        (0.5, 0.0, 0.3)
    """
    if not isinstance(opens, str):
        return MovablePart("drawer", "slide", (0.0, 0.0, 1.0), corner, opens)
    name, axis, (across, up), reach = _HINGES[opens]
    point = (corner[0] + across * size[0], corner[1] + up * size[1], corner[2])
    return MovablePart(name, "hinge", axis, point, reach)


def lid_part(y: float, z: float, x: float = 0.0) -> MovablePart:
    """Return the part of a lid hinged at its back edge, at height y and depth z; x separates equal lids [m]."""
    return MovablePart("lid", "hinge", (-1.0, 0.0, 0.0), (x, y, z), LID_ANGLE)


def assign_part(part: MovablePart | None, pieces: Iterable[Solid]) -> Iterator[Solid]:
    """Assign pieces to a part; None clears it."""
    for piece in pieces:
        yield replace(piece, part=part)


def panel(opens: OpeningMotion, board: Solid, *others: Solid, name: str | None = None) -> Iterator[Solid]:
    """Build one part from a board towards +z and the pieces fixed to it.

    Args:
        opens: Hinged edge, or the distance a drawer slides out [m].
        board: Front board; its bounding box defines the edges.
        others: Handles, panes and other fixed pieces.
        name: Name of the part; None derives it from its motion.
    """
    (x0, y0, _), (x1, y1, z1) = board.box.tolist()
    part = front_part(opens, (x0, y0, z1), (x1 - x0, y1 - y0))
    yield from assign_part(replace(part, name=name or part.name), (board, *others))


def collect_parts(pieces: Iterable[Solid]) -> list[MovablePart]:
    """Return the distinct parts of pieces, in order."""
    return list(dict.fromkeys(piece.part for piece in pieces if piece.part is not None))


def make_joints(model_id: str, solids: Sequence[Solid], mesh: Mesh) -> tuple[Joint, ...]:
    """Return the joints of a model.

    Args:
        model_id: Id of the model.
        solids: Solids of the model, in its frame.
        mesh: Mesh that `to_mesh` made from the solids.
    """
    faces, count = _group_faces(solids, mesh), Counter[str]()
    joints = []
    for part, own in faces.items():
        count[part.name] += 1
        axis, point = _round_vector(part.axis), _round_vector(part.point)
        reach = round(float(part.travel), 6)
        name = f"{part.name}_{count[part.name]}"
        joints.append(Joint(model_id, name, part.kind, axis, point, 0.0, reach, _find_runs(own)))
    return tuple(joints)


def _group_faces(solids: Sequence[Solid], mesh: Mesh) -> dict[MovablePart, Int[np.ndarray, " _"]]:
    """Return the faces of each part as ascending positions in the OBJ file."""
    line = np.argsort(face_order(mesh))
    first = np.cumsum([0] + [len(solid.faces) for solid in solids])
    found: dict[MovablePart, list[np.ndarray]] = defaultdict(list)
    for solid, start in zip(solids, first, strict=False):
        if solid.part is not None:
            found[solid.part].append(line[start : start + len(solid.faces)])
    return {part: np.sort(np.concatenate(own)) for part, own in found.items()}


def _find_runs(numbers: Int[np.ndarray, " n"]) -> tuple[tuple[int, int], ...]:
    """Return the first and last number of each run of consecutive numbers."""
    breaks = np.flatnonzero(np.diff(numbers) != 1) + 1
    return tuple((int(run[0]), int(run[-1])) for run in np.split(numbers, breaks))


def _round_vector(values: Vector) -> Vector:
    x, y, z = (round(float(value), 6) + 0.0 for value in values)
    return x, y, z
