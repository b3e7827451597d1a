"""Movable parts of furniture: marks on the solids of a shape, and the joints of a model that come of them."""

from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np
from jaxtyping import Int

from home_mjx.datasets.joints import Joint
from home_mjx.datasets.suncg.write.obj import face_order
from home_mjx.schema.house import Mesh
from home_procgen.primitives.parts import Part
from home_procgen.primitives.solids import Solid, Vector

QUARTER = np.pi / 2
TIPPED = 1.0  # [rad], of fronts that tip out
LIFTED = 1.3  # [rad], of lids
# The edge that a front towards +z hangs on, or how far it is pulled out [m]; `tips`: on the lower one, and not far.
Opens = Literal["left", "right", "bottom", "top", "tips"] | float
_HUNG = {
    "left": ("door", (0.0, -1.0, 0.0), (0.0, 0.0), QUARTER),
    "right": ("door", (0.0, 1.0, 0.0), (1.0, 0.0), QUARTER),
    "bottom": ("door", (1.0, 0.0, 0.0), (0.0, 0.0), QUARTER),
    "top": ("flap", (-1.0, 0.0, 0.0), (0.0, 1.0), QUARTER),
    "tips": ("flap", (1.0, 0.0, 0.0), (0.0, 0.0), TIPPED),
}


def front_part(opens: Opens, corner: Vector, size: tuple[float, float]) -> Part:
    """The part of a front towards +z. It turns about an outer edge, so that it never turns into what is beside it.

    Args:
        opens: How.
        corner: Lower left corner of its outer face [m].
        size: Width and height [m].

    Example:
        >>> front_part("right", (0.0, 0.0, 0.3), (0.5, 2.0)).point
        (0.5, 0.0, 0.3)
    """
    if not isinstance(opens, str):
        return Part("drawer", "slide", (0.0, 0.0, 1.0), corner, opens)
    name, axis, (across, up), reach = _HUNG[opens]
    point = (corner[0] + across * size[0], corner[1] + up * size[1], corner[2])
    return Part(name, "hinge", axis, point, reach)


def lid_part(y: float, z: float, x: float = 0.0) -> Part:
    """The part of a lid that opens upwards about its back edge, at height y and depth z; x tells it from others [m]."""
    return Part("lid", "hinge", (-1.0, 0.0, 0.0), (x, y, z), LIFTED)


def marked(part: Part | None, pieces: Iterable[Solid]) -> Iterator[Solid]:
    """Pieces that belong to a part."""
    for piece in pieces:
        yield replace(piece, part=part)


def panel(opens: Opens, board: Solid, *others: Solid, name: str | None = None) -> Iterator[Solid]:
    """A board towards +z and what is fixed to it, as one part.

    Args:
        opens: How.
        board: The front; its box has the edges.
        others: Handles, panes and so on.
        name: What it is, if it is not called after how it moves.
    """
    (x0, y0, _), (x1, y1, z1) = board.box.tolist()
    part = front_part(opens, (x0, y0, z1), (x1 - x0, y1 - y0))
    yield from marked(replace(part, name=name or part.name), (board, *others))


def parts_of(pieces: Iterable[Solid]) -> list[Part]:
    """The parts of some pieces, in order."""
    return list(dict.fromkeys(piece.part for piece in pieces if piece.part is not None))


def joints_of(model_id: str, solids: Sequence[Solid], mesh: Mesh) -> tuple[Joint, ...]:
    """The joints of a model.

    Args:
        model_id: Its id.
        solids: What it was made of, in the model's frame.
        mesh: The mesh that `to_mesh` made of them.
    """
    faces, count = _faces_by_part(solids, mesh), Counter[str]()
    joints = []
    for part, own in faces.items():
        count[part.name] += 1
        axis, point = _rounded(part.axis), _rounded(part.point)
        reach = round(float(part.reach), 6)
        name = f"{part.name}_{count[part.name]}"
        joints.append(Joint(model_id, name, part.kind, axis, point, 0.0, reach, _runs(own)))
    return tuple(joints)


def _faces_by_part(solids: Sequence[Solid], mesh: Mesh) -> dict[Part, Int[np.ndarray, " _"]]:
    """Faces of each part by where they are in the OBJ, in ascending order."""
    line = np.argsort(face_order(mesh))
    first = np.cumsum([0] + [len(solid.faces) for solid in solids])
    found: dict[Part, list[np.ndarray]] = defaultdict(list)
    for solid, start in zip(solids, first, strict=False):
        if solid.part is not None:
            found[solid.part].append(line[start : start + len(solid.faces)])
    return {part: np.sort(np.concatenate(own)) for part, own in found.items()}


def _runs(numbers: Int[np.ndarray, " n"]) -> tuple[tuple[int, int], ...]:
    """First and last of each run of consecutive numbers."""
    breaks = np.flatnonzero(np.diff(numbers) != 1) + 1
    return tuple((int(run[0]), int(run[-1])) for run in np.split(numbers, breaks))


def _rounded(values: Vector) -> Vector:
    x, y, z = (round(float(value), 6) + 0.0 for value in values)
    return x, y, z
