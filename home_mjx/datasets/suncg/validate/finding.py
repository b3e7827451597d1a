"""Findings of the validator, and the rules that they violate."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, NamedTuple

Severity = Literal["error", "warning"]


class ValidationRule(NamedTuple):
    """One rule of the validator."""

    severity: Severity  # error: data is lost or contradictory; warning: unusual, but usable
    meaning: str


RULES: Mapping[str, ValidationRule] = {
    # whole files
    "unreadable": ValidationRule("error", "a file or value that is missing, broken or out of its format"),
    "tolerated": ValidationRule("warning", "an irregularity that the reader of another format than SUNCG's tolerates"),
    "format-version": ValidationRule("warning", "a version that is neither SUNCG v1 nor v2"),
    "house-id": ValidationRule(
        "error", "an id that is not the name of the folder, by which other readers find the rooms"
    ),
    "axes": ValidationRule("warning", "other axes than up +y and front +z"),
    "nothing-shown": ValidationRule("error", "a house without any visible node"),
    "no-room": ValidationRule("error", "a house without a room that has a mesh, which cannot be compiled"),
    "unknown-field": ValidationRule("warning", "a field that the format does not have"),
    # nodes
    "empty-level": ValidationRule("warning", "a level without a list of nodes"),
    "empty-node": ValidationRule("warning", "an empty node"),
    "node-type": ValidationRule("warning", "a node of an unknown type"),
    "missing-id": ValidationRule("warning", "a level or node without an id"),
    "duplicate-id": ValidationRule("error", "two nodes of one id"),
    "id-position": ValidationRule("warning", "an id that is not <level>_<position in its list>"),
    "missing-transform": ValidationRule("error", "an object or box without a transform"),
    "flat-transform": ValidationRule("error", "a singular transform"),
    "mirror-flag": ValidationRule("error", "isMirrored contradicts the sign of the transform's determinant"),
    "missing-mirror-flag": ValidationRule("warning", "a mirrored node without isMirrored"),
    "missing-variant": ValidationRule("error", "a state for which the model has no variant"),
    "broken-variant": ValidationRule("error", "a broken variant of a model that is used in another state"),
    "flat-box": ValidationRule("error", "a box without volume"),
    "backdrop": ValidationRule("warning", "a box of 20 m and more, such as a landscape"),
    "unknown-model": ValidationRule("warning", "a model without a row in ModelCategoryMapping.csv"),
    # boxes
    "missing-bbox": ValidationRule("warning", "no bounding box"),
    "inverted-bbox": ValidationRule("error", "a bounding box whose minimum is above its maximum"),
    "bbox-mismatch": ValidationRule("error", "a bounding box that differs from that of the base model's vertices"),
    "room-bbox": ValidationRule("warning", "a room or ground that extends beyond its bounding box"),
    "level-bbox": ValidationRule(
        "warning", "a bounding box of a level or house that differs from that of its nodes or levels"
    ),
    # rooms
    "room-type": ValidationRule("warning", "an unknown room type"),
    "missing-part": ValidationRule("error", "a room or ground without the mesh of a part that is not hidden"),
    "member-index": ValidationRule("error", "nodeIndices beyond the level's nodes"),
    "repeated-member": ValidationRule("warning", "nodeIndices that list a node twice"),
    "text-member": ValidationRule("warning", "nodeIndices written as strings, as deep-synth and PlanIT do"),
    "shared-member": ValidationRule("warning", "nodeIndices of two rooms that list one node"),
    "hidden-member": ValidationRule("warning", "nodeIndices that list a hidden node"),
    "member-type": ValidationRule("error", "nodeIndices that list a room or ground"),
    "room-overlap": ValidationRule("warning", "two rooms of a level that overlap or nest"),
    "outside-rooms": ValidationRule("warning", "an object or box outside all rooms and grounds"),
    "door-off-wall": ValidationRule("warning", "a door, window or arch that is not in a wall"),
    "thick-wall": ValidationRule("error", "a wall of more than 1 m: several walls in one mesh group become one block"),
    "floor-down": ValidationRule("warning", "a floor whose upper side faces down"),
    "flat-wall": ValidationRule("warning", "a wall without length"),
    "element-type": ValidationRule("warning", "an architectural element of an unknown type"),
    "unreachable-storey": ValidationRule(
        "warning", "a storey that agents cannot reach from the ground floor, because no stairs connect it"
    ),
    # models
    "flat-model": ValidationRule("warning", "a model without thickness, which never moves"),
    "bridged-face": ValidationRule("warning", "a face that visits a corner twice, such as one with a hole"),
    "bent-face": ValidationRule("warning", "a face of more than four corners that are not in one plane"),
    "unread-statement": ValidationRule("warning", "a statement of an OBJ or MTL that is unknown or has no effect here"),
    "clamped-value": ValidationRule("warning", "a colour, opacity or `Ns` of an MTL outside of its range"),
    "ambiguous-opacity": ValidationRule("warning", "a `Tr` of an MTL without `d` that may be opacity or transparency"),
    # joints
    "joint-model": ValidationRule("error", "a joint of a model without a row in ModelCategoryMapping.csv"),
    "joint-faces": ValidationRule("error", "faces of a joint that its model lacks, or that belong to two joints"),
    # materials
    "extra-materials": ValidationRule("warning", "more materials than the model has slots"),
    "unused-slot": ValidationRule("warning", "a material slot without faces"),
    "missing-slot": ValidationRule("warning", "faces without a material"),
    "texture-broken": ValidationRule("error", "a texture that does not decode"),
    "texture-type": ValidationRule("warning", "a texture whose name has the extension of another kind of image"),
}


@dataclass(frozen=True)
class ValidationFinding:
    """A fault of a house.

    Example:
        >>> finding = ValidationFinding("house.json", "levels[0].nodes[3].bbox", "bbox-mismatch", "0.57 m off")
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
