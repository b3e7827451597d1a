"""Labels of scans: HM3D's coloured meshes and Matterport3D's `.house` files with labelled PLY."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import KDTree

from home_mjx.core.files import is_file, read_text
from home_mjx.core.images import open_texture
from home_mjx.datasets.gltf.categories import ARCHITECTURE
from home_mjx.datasets.gltf.decode.scene import Matrix, PlacedMesh
from home_mjx.datasets.gltf.layout.room_file import StatedRoom
from home_mjx.datasets.gltf.layout.triangle_set import TriangleSet
from home_mjx.datasets.gltf.objects import MeshObject
from home_mjx.datasets.habitat.assets import AssetStore
from home_mjx.datasets.habitat.matterport import read_house_file, read_labelled_ply
from home_mjx.datasets.habitat.semantics import fine_of_word
from home_mjx.datasets.habitat.templates import HabitatTemplate, path_below
from home_mjx.datasets.suncg.formats.json_value import Location
from home_mjx.datasets.taxonomy import UNKNOWN
from home_mjx.schema.house import Problem

MAX_DISTANCE = 0.05  # [m], from a face of the scan to the labelled face that names it
MIN_FACES = 10  # minimum number of faces of an instance; smaller ones stay with the architecture
MAX_OBJECTS = 4_000  # maximum number of instances that become objects
MAX_TEXT_BYTES = 1 << 26  # [bytes]
HM3D_ROW = re.compile(r'\s*(\d+)\s*,\s*([0-9A-Fa-f]{6})\s*,\s*"([^"]*)"\s*,\s*(-?\d+)\s*')


@dataclass(frozen=True)
class ScanLabels:
    """Labelled faces of a scan in the house, and its regions.

    Attributes:
        points: Centroids of labelled faces [m].
        instance: Instance of each.
        words: Word of each instance.
        rooms: Regions.
        problems: What is not used.
    """

    points: Float[np.ndarray, "f 3"] = field(default_factory=lambda: np.zeros((0, 3)))
    instance: Int[np.ndarray, " f"] = field(default_factory=lambda: np.zeros(0, int))
    words: dict[int, str] = field(default_factory=dict)
    rooms: tuple[StatedRoom, ...] = ()
    problems: tuple[Problem, ...] = ()

    def split(self, triangles: TriangleSet) -> tuple[list[MeshObject], TriangleSet]:
        """Return the labelled furniture of a scan as objects, and all other triangles."""
        if not len(self.points) or not len(triangles):
            return [], triangles
        away, nearest = KDTree(self.points).query(triangles.middle, distance_upper_bound=MAX_DISTANCE)
        label = np.where(np.isfinite(away), self.instance[np.minimum(nearest, len(self.points) - 1)], -1)
        found, taken = [], np.zeros(len(triangles), bool)
        for number, count in zip(*np.unique(label, return_counts=True), strict=True):
            word = self.words.get(int(number), "")
            fine = fine_of_word(word) if word else UNKNOWN
            if fine not in (*ARCHITECTURE, UNKNOWN, "stairs") and count >= MIN_FACES and len(found) < MAX_OBJECTS:
                mine = label == number
                taken |= mine
                found.append(_object(triangles[mine], fine, int(number), word))
        return found, triangles[~taken]


def _object(triangles: TriangleSet, fine: str, number: int, word: str) -> MeshObject:
    """Return faces of a scan as an object around the middle of its base."""
    points = triangles.corners.reshape(-1, 3)
    low, high = points.min(axis=0), points.max(axis=0)
    matrix = np.eye(4)
    matrix[:3, 3] = (low[0] + high[0]) / 2, low[1], (low[2] + high[2]) / 2
    moved = TriangleSet(triangles.corners - matrix[:3, 3], triangles.uv, triangles.slot, triangles.materials)
    extra = {"name": f"{word}_{number}", "category": word}
    return MeshObject(fine, f"{fine}_scan_{number}", matrix, moved.mesh(Path("scan")), (), extra)


def read_scan_labels(template: HabitatTemplate, root: Path, matrix: Matrix, assets: AssetStore) -> ScanLabels:
    """Return the labels of a stage that is a scan; empty, with a note, if a file is missing.

    Args:
        template: The stage, whose `semantic_descriptor_filename` and `semantic_asset` name the files.
        root: Folder that contains all files.
        matrix: House from the stage's mesh.
        assets: Assets of the house.

    Raises:
        DatasetError: A file is broken, or leads out of the root.
    """
    named, folder = template.text("semantic_descriptor_filename")
    mesh, mesh_folder = template.text("semantic_asset")
    if not named.has_value:
        return ScanLabels()
    descriptor = path_below(root, folder, named)
    faces = path_below(root, mesh_folder, mesh) if mesh.has_value else None
    if not is_file(descriptor):
        return ScanLabels()
    if descriptor.suffix == ".house":
        house = read_house_file(descriptor, matrix)
        points, instance = np.zeros((0, 3)), np.zeros(0, int)
        if faces is not None and is_file(faces):
            points, instance = read_labelled_ply(faces, matrix)
        return ScanLabels(points, instance, dict(house.words), house.rooms, house.problems)
    if descriptor.suffix != ".txt":
        note = f"descriptors of the format `{descriptor.suffix[:20]}` are not read"
        return ScanLabels(problems=(Problem(descriptor.name, note),))
    colors, words = read_hm3d_text(descriptor)
    if faces is None or not is_file(faces):
        return ScanLabels(problems=(Problem(descriptor.name, "mesh with the colours of instances is missing"),))
    points, found = _colored_faces(assets.placed(faces, matrix))
    order = np.searchsorted(colors, found)
    order = np.minimum(order, len(colors) - 1)
    return ScanLabels(points, np.where(colors[order] == found, order, -1), dict(enumerate(words)))


def read_hm3d_text(path: Path) -> tuple[Int[np.ndarray, " n"], list[str]]:
    """Return the colours 0xRRGGBB of the instances of a `.semantic.txt`, ascending, and the word of each.

    Raises:
        DatasetError: A row has another form; the message names the line.
    """
    lines = read_text(path, max_bytes=MAX_TEXT_BYTES).splitlines()
    found: dict[int, str] = {}
    for number, line in enumerate(lines[1:], 2):
        row = HM3D_ROW.fullmatch(line)
        if row is None and line.strip():
            raise Location(path, f"line {number}").error('expected `id,RRGGBB,"name",region`')
        if row is not None:
            found[int(row[2], 16)] = row[3][:100]
    if not found:
        raise Location(path).error("file has no instances")
    colors = sorted(found)
    return np.array(colors), [found[color] for color in colors]


def _colored_faces(placed: Sequence[PlacedMesh]) -> tuple[Float[np.ndarray, "f 3"], Int[np.ndarray, " f"]]:
    """Return the centroids of the faces of meshes in the house, and the colour 0xRRGGBB of each: the nearest texel."""
    points, colors = [np.zeros((0, 3))], [np.zeros(0, int)]
    for item in placed:
        mesh = item.mesh
        corners = (mesh.vertices @ item.matrix[:3, :3].T + item.matrix[:3, 3])[mesh.faces]
        points.append(corners.mean(axis=1))
        colors.append(_texels(item))
    return np.concatenate(points), np.concatenate(colors)


def _texels(item: PlacedMesh) -> Int[np.ndarray, " f"]:
    """Return the colour 0xRRGGBB of the texel at the middle of each face; that of its material without a texture."""
    mesh, found = item.mesh, np.zeros(len(item.mesh.faces), int)
    for slot, material in enumerate(mesh.materials):
        mine = np.flatnonzero(mesh.slot == slot)
        if material.texture is None:
            rgb = np.round(np.array(material.diffuse or (0, 0, 0)) * 255).astype(int)
            found[mine] = rgb @ [1 << 16, 1 << 8, 1]
        elif len(mine):
            image = np.asarray(open_texture(material.texture).convert("RGB"))
            height, width = image.shape[:2]
            u, v = (mesh.uv[mine].mean(axis=1) % 1.0).T
            x, y = (
                np.minimum((u * width).astype(int), width - 1),
                np.minimum(((1 - v) * height).astype(int), height - 1),
            )
            found[mine] = image[y, x].astype(int) @ [1 << 16, 1 << 8, 1]
    return found
