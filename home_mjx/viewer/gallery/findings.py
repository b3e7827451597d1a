"""Findings of the validator at their places in a house (host only)."""

import re
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from home_mjx.datasets import ValidationFinding
from home_mjx.geometry.meshes import Z_UP
from home_mjx.schema.house import House, Level, Mesh

NODE = re.compile(r"levels\[\d+\]\.nodes\[\d+\]")  # path of a node in the element of a finding
OTHER_NODE = re.compile(r"[\w.\[\]]+")  # the same in other formats, whose readers give paths of their own


class PlacedFinding(NamedTuple):
    """A finding, and where it is.

    Attributes:
        finding: The finding.
        place: Middle of its node [m], in the frame of the compiled house; None: it is of the whole house or its files.
    """

    finding: ValidationFinding
    place: Float[np.ndarray, "3"] | None


def place_findings(
    house: House, findings: Iterable[ValidationFinding], offset: Float[np.ndarray, "3"]
) -> list[PlacedFinding]:
    """Return findings with the places of their nodes.

    Args:
        house: The house as read.
        findings: Its findings.
        offset: Translation of the compiled house, `CompiledHouse.offset` [m].
    """
    places = {path: Z_UP @ middle + offset for level in house.levels for path, middle in _middles(level).items()}
    return [PlacedFinding(finding, places.get(_node_of(finding.element, places))) for finding in findings]


def _node_of(element: str, known: dict[str, np.ndarray]) -> str:
    """Return the path of the node of an element; "" if it is in none."""
    found = NODE.match(element) or OTHER_NODE.match(element)
    path = found.group() if found else ""
    while path and path not in known:
        path = path.rpartition(".")[0]
    return path


def _middles(level: Level) -> dict[str, Float[np.ndarray, "3"]]:
    """Return the middles of a level's objects, boxes and rooms by path, in the file's frame [m]."""
    still = {node.path: node.transform[:3, 3] for node in level.boxes}
    objects = {
        node.path: node.transform[:3, 3] if node.bbox is None else node.bbox.mean(axis=0) for node in level.objects
    }
    meshes = {room.path: (room.floor, room.walls, room.ceiling) for room in level.rooms}
    return {**still, **objects, **{path: _middle(*parts) for path, parts in meshes.items() if any(parts)}}


def _middle(*meshes: Mesh | None) -> Float[np.ndarray, "3"]:
    """Return the middle of the bounds of meshes [m]; at least one is given."""
    corners = np.concatenate([mesh.vertices for mesh in meshes if mesh is not None])
    return (corners.min(axis=0) + corners.max(axis=0)) / 2
