"""Rules on meshes: walls are single walls, floors face up, and joints name faces that exist, each once."""

from itertools import pairwise

import numpy as np
from jaxtyping import Float

from home_mjx.datasets.suncg.read.joints import JOINTS
from home_mjx.datasets.suncg.validate.context import ValidationContext
from home_mjx.geometry.meshes import facing_axis
from home_mjx.schema.house import Joint, Mesh

MAX_WALL_THICKNESS = 1.0  # [m], maximum thickness of a wall; SUNCG's have 0.1 m
MIN_UPWARD_COSINE = 0.7  # minimum cosine to the vertical: slopes below 45 degrees
HEIGHT_TOLERANCE = 1e-3  # [m], maximum difference in height within one surface

Corners = Float[np.ndarray, "_ 3 3"]  # [m], Y up


def check_meshes(subject: ValidationContext) -> None:
    """Report walls that are too thick to be one wall, and floors that face down."""
    for room in (room for level in subject.house.levels for room in level.rooms):
        if room.walls is not None:
            _check_walls(subject, room.walls)
        if room.floor is not None and not _faces_up(room.floor):
            message = "its upper side faces down: corners must run counter-clockwise, seen from above"
            subject.report("floor-down", ", ".join(room.floor.groups), message, room.floor.path)


def _check_walls(subject: ValidationContext, walls: Mesh) -> None:
    """Report parts of the walls that are thicker than `MAX_WALL_THICKNESS`."""
    for faces in walls.faces_by_part():
        thickness = _thickness(walls, faces)
        if thickness > MAX_WALL_THICKNESS:
            groups = [walls.groups[i] for i in np.unique(walls.group[faces]) if i >= 0]
            message = f"{thickness:.1f} m thick: give every wall a mesh group of its own"
            subject.report("thick-wall", ", ".join(groups), message, walls.path)


def _thickness(walls: Mesh, faces: np.ndarray) -> float:
    """Return the extent of some faces in the horizontal direction that most of their area faces [m]."""
    corners = walls.vertices[walls.faces[faces]].astype(np.float64)
    normal, area = _normals(corners)
    return float(np.ptp(corners[..., [0, 2]] @ facing_axis(normal[:, [0, 2]], area)))


def _faces_up(floor: Mesh) -> bool:
    """Return whether one of the highest of a floor's roughly horizontal faces faces up; False without such faces.

    Those of an inverted slab face down.
    """
    corners = floor.vertices[floor.faces].astype(np.float64)
    normal, area = _normals(corners)
    height = np.where(abs(normal[:, 1]) > MIN_UPWARD_COSINE * area, corners[..., 1].mean(axis=1), -np.inf)
    return bool((normal[height > height.max() - HEIGHT_TOLERANCE, 1] > 0).any())


def _normals(corners: Corners) -> tuple[Float[np.ndarray, "_ 3"], Float[np.ndarray, " _"]]:
    """Compute normals scaled by their triangles' areas, and these areas [m^2]."""
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
    return normal, np.linalg.norm(normal, axis=1)


def check_joints(subject: ValidationContext) -> None:
    """Report joints of unknown models; in models of the house, joints of missing faces and faces of two joints."""
    for model_id, joints in subject.joints.items():
        if subject.metadata is not None and model_id not in subject.metadata.models:
            _report(subject, "joint-model", model_id, "the model has no row in the category table")
        mesh = subject.house.models.get(model_id)
        if mesh is not None:
            _check_faces(subject, joints, mesh)


def _check_faces(subject: ValidationContext, joints: tuple[Joint, ...], mesh: Mesh) -> None:
    """Report joints with faces that the mesh lacks, and faces of two joints."""
    for joint in joints:
        if joint.face_ranges[-1][1] >= len(mesh.faces):
            message = f"face {joint.face_ranges[-1][1]} of a model that has {len(mesh.faces)}"
            _report(subject, "joint-faces", f"{joint.model_id} {joint.part}", message)
    runs = sorted((*run, joint.part) for joint in joints for run in joint.face_ranges)
    for (_, last, part), (first, _, other) in pairwise(runs):
        if first <= last:
            _report(subject, "joint-faces", f"{joints[0].model_id} {other}", f"face {first} is of {part} as well")


def _report(subject: ValidationContext, rule: str, element: str, message: str) -> None:
    """Report a finding whose file is the dataset's table of joints, metadata/joints.csv."""
    subject.report(rule, element, message, subject.reading.assets.root / "metadata" / JOINTS)
