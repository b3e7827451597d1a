"""Cutting of backdrops: boxes of about a hundred metres that show a landscape behind the windows."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Float

from home_mjx.datasets.suncg.formats.json_value import Location
from home_mjx.datasets.suncg.read.reader_state import ReaderState
from home_mjx.schema.house import BoxNode, GroundNode, Node, ObjectNode, RoomNode

MAX_BOX_EDGE = 20.0  # [m], maximum edge of ordinary boxes; longer ones may be backdrops
MAX_AXIS_SINE = 1e-3  # maximum sine of the angle between the axes and a box that is cut


def cut_backdrops(nodes: Sequence[Node], place: Location, reading: ReaderState) -> list[Node]:
    """Return a level's nodes with boxes over 20 m cut to `level_extent`; those outside of it or slanted are removed.

    Changes are noted as problems; `place` names the file. Large boxes within the extent are unchanged. With the option
    `backdrops`, or without an extent, all nodes are unchanged.
    """
    extent = None if reading.options.backdrops else level_extent(nodes)
    if extent is None:
        return list(nodes)
    return [
        kept for node in nodes if (kept := _cut(node, extent, Location(place.file, node.path), reading)) is not None
    ]


def level_extent(nodes: Sequence[Node]) -> Float[np.ndarray, "2 3"] | None:
    """Return the bounding box of the meshes of rooms and grounds, and of the file's boxes of objects [m].

    Rooms and grounds without meshes, objects without `bbox`, and boxes are left out; None if nothing remains. The
    file's boxes of rooms are not usable, since they enclose the members, including backdrops.
    """
    rooms = [part for node in nodes if isinstance(node, RoomNode) for part in (node.floor, node.ceiling, node.walls)]
    meshes = [*rooms, *(node.mesh for node in nodes if isinstance(node, GroundNode))]
    corners = [[mesh.vertices.min(0), mesh.vertices.max(0)] for mesh in meshes if mesh is not None]
    corners += [list(node.bbox) for node in nodes if isinstance(node, ObjectNode) and node.bbox is not None]
    if not corners:
        return None
    low, high = np.array(corners).transpose(1, 0, 2)
    return np.stack([low.min(0), high.max(0)])


def box_bounds(box: BoxNode) -> Float[np.ndarray, "2 3"]:
    """Return the lower and upper corner of a box's axis-aligned bounds in the scene [m]."""
    half = abs(box.transform[:3, :3]) @ box.dimensions / 2
    return np.stack([box.transform[:3, 3] - half, box.transform[:3, 3] + half])


def _cut(node: Node, extent: Float[np.ndarray, "2 3"], place: Location, reading: ReaderState) -> Node | None:
    """Return a node unchanged, or a large box cut to `extent`; None, noted, for one that is outside or slanted."""
    if not isinstance(node, BoxNode):
        return node
    bounds = box_bounds(node)
    inside = np.stack([np.maximum(bounds[0], extent[0]), np.minimum(bounds[1], extent[1])])
    if np.ptp(bounds, axis=0).max() <= MAX_BOX_EDGE or np.array_equal(inside, bounds):
        return node
    if (inside[1] - inside[0] <= 0).any() or not _along_axes(node):
        reading.note(place, "backdrop", "backdrop box: left out")
        return None
    reading.note(place, "backdrop", "backdrop box: cut to the extent of the level")
    return _resize(node, inside)


def _along_axes(box: BoxNode) -> bool:
    """Return whether each edge of a box is along some axis of the scene, within `MAX_AXIS_SINE`."""
    columns = abs(box.transform[:3, :3] / np.linalg.norm(box.transform[:3, :3], axis=0))
    return bool((np.sort(columns, axis=0)[:2] < MAX_AXIS_SINE).all())


def _resize(box: BoxNode, bounds: Float[np.ndarray, "2 3"]) -> BoxNode:
    """Resize a box whose edges are along the axes to fill bounds [m], in the same orientation."""
    transform = box.transform.copy()
    transform[:3, 3] = bounds.mean(axis=0)
    axes = abs(box.transform[:3, :3]).argmax(axis=0)
    scale = np.linalg.norm(box.transform[:3, :3], axis=0)
    return replace(box, transform=transform, dimensions=np.ptp(bounds, axis=0)[axes] / scale)
