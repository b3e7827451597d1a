"""Input and findings of the validator's rules."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from jaxtyping import Float

from home_mjx.datasets.suncg.formats.json_value import JsonValue, printable
from home_mjx.datasets.suncg.read.backdrops import box_bounds
from home_mjx.datasets.suncg.read.house_json import MAX_NODES
from home_mjx.datasets.suncg.read.reader_state import ReaderState
from home_mjx.datasets.suncg.validate.finding import ValidationFinding
from home_mjx.errors import DatasetError
from home_mjx.schema.house import BoxNode, GroundNode, House, Joints, Level, Metadata, Node, ObjectNode, RoomNode

Bounds = Float[np.ndarray, "2 3"]


def level_nodes(level: Level) -> tuple[Node, ...]:
    """Return the rooms, grounds, objects and boxes of a level, in this order; hidden and unknown nodes are left out."""
    return (*level.rooms, *level.grounds, *level.objects, *level.boxes)


@dataclass
class ValidationContext:
    """A house under validation."""

    document: JsonValue  # house.json
    reading: ReaderState
    house: House  # the parts that could be read
    metadata: Metadata | None  # None if it cannot be read
    joints: Joints = field(default_factory=dict)  # joints of library models; empty if they cannot be read
    findings: list[ValidationFinding] = field(default_factory=list)
    _bounds: dict[str, Bounds | None] = field(default_factory=dict)

    def report(self, rule: str, element: str, message: str, file: Path | None = None) -> None:
        """Record a finding; the file is house.json by default."""
        where = str(self.document.file if file is None else file)
        self.findings.append(ValidationFinding(where, printable(element), rule, printable(message)))

    @property
    def nodes(self) -> Iterator[Node]:
        """Yield all nodes that could be read, level by level."""
        for level in self.house.levels:
            yield from level_nodes(level)

    def entries(self) -> Iterator[tuple[int, JsonValue, list[JsonValue]]]:
        """Yield index, level and nodes of each level of the file; no nodes if they are not a list or too many."""
        levels = self.document.data.get("levels")
        for index, level in enumerate(levels if isinstance(levels, list) else []):
            if isinstance(level, dict):
                value, nodes = JsonValue(self.document.file, f"levels[{index}]", level), level.get("nodes")
                usable = isinstance(nodes, list) and len(nodes) <= MAX_NODES
                yield index, value, value.member("nodes").entries() if usable else []

    def bounds(self, node: Node) -> Bounds | None:
        """Return the bounds of a node [m], of an object's base model in every state; None without a readable mesh."""
        if node.path not in self._bounds:
            self._bounds[node.path] = box_bounds(node) if isinstance(node, BoxNode) else self._mesh_bounds(node)
        return self._bounds[node.path]

    def _mesh_bounds(self, node: Node) -> Bounds | None:
        """Return the bounds of an object's base model, or of a room's or ground's meshes; None without any."""
        if isinstance(node, ObjectNode):
            points = self._base_vertices(node)
            return None if points is None else np.stack([points.min(axis=0), points.max(axis=0)])
        room = (node.floor, node.ceiling, node.walls) if isinstance(node, RoomNode) else ()
        meshes = [mesh for mesh in (*room, node.mesh if isinstance(node, GroundNode) else None) if mesh is not None]
        corners = [(mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)) for mesh in meshes]
        return np.stack([np.min(corners, axis=0)[0], np.max(corners, axis=0)[1]]) if corners else None

    def _base_vertices(self, item: ObjectNode) -> Float[np.ndarray, "_ 3"] | None:
        """Return the vertices of an object's base model in the scene [m]; None, reported, if it cannot be read."""
        place = JsonValue(self.document.file, f"{item.path}.modelId", item.model_id)
        try:
            mesh = self.reading.model(item.model_id, item.model_id, place)
        except DatasetError as error:
            self.report("unreadable", place.element, error.message)
            return None
        return mesh.vertices @ item.transform[:3, :3].T + item.transform[:3, 3]
