"""Findings of the validator, and the rules that they violate."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, NamedTuple

Severity = Literal["error", "warning"]


class Rule(NamedTuple):
    """One rule of the validator."""

    severity: Severity  # error: data is lost or contradictory; warning: unusual, but usable
    meaning: str


RULES: Mapping[str, Rule] = {
    # whole files
    "unreadable": Rule("error", "a file or value that is missing, broken or out of its format"),
    "format-version": Rule("warning", "a version that is neither SUNCG v1 nor v2"),
    "house-id": Rule("error", "an id that is not the name of the folder, by which other readers find the rooms"),
    "axes": Rule("warning", "other axes than up +y and front +z"),
    "nothing-shown": Rule("error", "a house without any visible node"),
    "no-room": Rule("error", "a house without a room that has a mesh, which cannot be compiled"),
    "unknown-field": Rule("warning", "a field that the format does not have"),
    # nodes
    "empty-level": Rule("warning", "a level without a list of nodes"),
    "empty-node": Rule("warning", "an empty node"),
    "node-type": Rule("warning", "a node of an unknown type"),
    "missing-id": Rule("warning", "a level or node without an id"),
    "duplicate-id": Rule("error", "two nodes of one id"),
    "id-position": Rule("warning", "an id that is not <level>_<position in its list>"),
    "missing-transform": Rule("error", "an object or box without a transform"),
    "flat-transform": Rule("error", "a singular transform"),
    "mirror-flag": Rule("error", "isMirrored contradicts the sign of the transform's determinant"),
    "missing-mirror-flag": Rule("warning", "a mirrored node without isMirrored"),
    "missing-variant": Rule("error", "a state for which the model has no variant"),
    "broken-variant": Rule("error", "a broken variant of a model that is used in another state"),
    "flat-box": Rule("error", "a box without volume"),
    "backdrop": Rule("warning", "a box of 20 m and more, such as a landscape"),
    "unknown-model": Rule("warning", "a model without a row in ModelCategoryMapping.csv"),
    # boxes
    "missing-bbox": Rule("warning", "no bounding box"),
    "inverted-bbox": Rule("error", "a bounding box whose minimum is above its maximum"),
    "bbox-mismatch": Rule("error", "a bounding box that differs from that of the base model's vertices"),
    "room-bbox": Rule("warning", "a room or ground that extends beyond its bounding box"),
    "level-bbox": Rule("warning", "a bounding box of a level or house that differs from that of its nodes or levels"),
    # rooms
    "room-type": Rule("warning", "an unknown room type"),
    "missing-part": Rule("error", "a room or ground without the mesh of a part that is not hidden"),
    "member-index": Rule("error", "nodeIndices beyond the level's nodes"),
    "repeated-member": Rule("warning", "nodeIndices that list a node twice"),
    "text-member": Rule("warning", "nodeIndices written as strings, as deep-synth and PlanIT do"),
    "shared-member": Rule("warning", "nodeIndices of two rooms that list one node"),
    "hidden-member": Rule("warning", "nodeIndices that list a hidden node"),
    "member-type": Rule("error", "nodeIndices that list a room or ground"),
    "room-overlap": Rule("warning", "two rooms of a level that overlap or nest"),
    "outside-rooms": Rule("warning", "an object or box outside all rooms and grounds"),
    "door-off-wall": Rule("warning", "a door, window or arch that is not in a wall"),
    "thick-wall": Rule("error", "a wall of more than 1 m: several walls in one mesh group become one block"),
    "floor-down": Rule("warning", "a floor whose upper side faces down"),
    "flat-wall": Rule("warning", "a wall without length"),
    "element-type": Rule("warning", "an architectural element of an unknown type"),
    # joints
    "joint-model": Rule("error", "a joint of a model without a row in ModelCategoryMapping.csv"),
    "joint-faces": Rule("error", "faces of a joint that its model lacks, or that belong to two joints"),
    # materials
    "extra-materials": Rule("warning", "more materials than the model has slots"),
    "unused-slot": Rule("warning", "a material slot without faces"),
    "missing-slot": Rule("warning", "faces without a material"),
    "texture-broken": Rule("error", "a texture that does not decode"),
    "texture-type": Rule("warning", "a texture whose name has the extension of another kind of image"),
}


@dataclass(frozen=True)
class Finding:
    """A fault of a house.

    Example:
        >>> finding = Finding("house.json", "levels[0].nodes[3].bbox", "bbox-mismatch", "0.57 m off")
        >>> print(finding.severity, finding)
        error house.json: levels[0].nodes[3].bbox: 0.57 m off [bbox-mismatch]
    """

    file: str
    element: str
    rule: str  # key of RULES
    message: str

    @property
    def severity(self) -> Severity:
        """Severity of its rule."""
        return RULES[self.rule].severity

    def __str__(self) -> str:
        return ": ".join(part for part in (self.file, self.element, self.message) if part) + f" [{self.rule}]"
