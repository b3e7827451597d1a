"""Rules on bounding boxes: the file's boxes against the geometry."""

import numpy as np
from jaxtyping import Float

from home_mjx.datasets.suncg.formats.json_value import JsonValue
from home_mjx.datasets.suncg.read.backdrops import MAX_BOX_EDGE
from home_mjx.datasets.suncg.read.nodes import read_bbox
from home_mjx.datasets.suncg.validate.context import ValidationContext, level_nodes
from home_mjx.schema.house import BoxNode, Node, ObjectNode

BOX_TOLERANCE = 1e-3  # [m]; SUNCG's numbers were rounded to float32

Bounds = Float[np.ndarray, "2 3"]


def check_boxes(subject: ValidationContext) -> None:
    """Report bounding boxes that differ from those around their parts, and backdrops.

    Boxes of rooms and grounds may be larger than their meshes, not smaller. Differences up to `BOX_TOLERANCE` pass. A
    backdrop is a box node with an edge above `MAX_BOX_EDGE`.
    """
    for node in subject.nodes:
        _check_node(subject, node)
    read = {level.index: level_nodes(level) for level in subject.house.levels}
    levels = [
        _check_union(subject, level, [node.bbox for node in read.get(index, ())])
        for index, level, _ in subject.entries()
    ]
    _check_union(subject, subject.document, levels)


def _check_node(subject: ValidationContext, node: Node) -> None:
    """Report a node whose box differs from its geometry (of rooms and grounds: is exceeded), and a backdrop."""
    bounds = subject.bounds(node)
    if bounds is None:
        return
    if isinstance(node, BoxNode) and np.ptp(bounds, axis=0).max() > MAX_BOX_EDGE:
        subject.report("backdrop", node.path, f"box of {np.ptp(bounds, axis=0).max():.0f} m")
    if node.bbox is not None and isinstance(node, ObjectNode | BoxNode):
        _report(subject, "bbox-mismatch", node.path, abs(bounds - node.bbox), "from the vertices of the base model")
    elif node.bbox is not None:  # boxes of rooms also enclose their members
        outside = np.maximum((bounds - node.bbox) * [[-1], [1]], 0)
        _report(subject, "room-bbox", node.path, outside, "inside the mesh")


def _check_union(subject: ValidationContext, owner: JsonValue, parts: list[Bounds | None]) -> Bounds | None:
    """Report a level or house whose box differs from that around `parts`; return the latter, None without parts."""
    boxes = [box for box in parts if box is not None]
    if not boxes:
        return None
    union = np.stack([np.min(boxes, axis=0)[0], np.max(boxes, axis=0)[1]])
    stated = subject.reading.attempt(read_bbox, owner, subject.reading)
    if stated is not None:
        _report(subject, "level-bbox", owner.element, abs(union - stated), "from the box around its parts")
    return union


def _report(subject: ValidationContext, rule: str, element: str, off: Bounds, what: str) -> None:
    """Report the largest entry of `off` [m] beyond the tolerance, at its side and axis of a bounding box."""
    if off.max() > BOX_TOLERANCE:
        side, axis = np.unravel_index(off.argmax(), off.shape)
        place = f"{element}.bbox.{('min', 'max')[side]}[{axis}]".lstrip(".")
        subject.report(rule, place, f"{off.max():.3g} m {what}")
