"""Meshes of assets in their own frames: glTF files and the primitives that Habitat names."""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from jaxtyping import Float

from home_mjx.core.files import is_file
from home_mjx.datasets.gltf.decode.container import TEXTURE_EXTENSIONS, GltfDocument, read_document
from home_mjx.datasets.gltf.decode.images import ImageStore
from home_mjx.datasets.gltf.decode.materials import MaterialReader
from home_mjx.datasets.gltf.decode.primitives import MeshReader
from home_mjx.datasets.gltf.decode.scene import Matrix, PlacedMesh, SceneNode, place_meshes
from home_mjx.datasets.gltf.objects import join_meshes, move_mesh
from home_mjx.datasets.habitat.plain.plain_assets import (
    GREY,
    PLAIN_SUFFIXES,
    missing_parts,
    plain_mesh,
    read_plain_asset,
)
from home_mjx.datasets.shapes import (
    capsule_triangles,
    cone_triangles,
    cylinder_triangles,
    sphere_triangles,
)
from home_mjx.datasets.suncg.formats.json_value import JsonValue
from home_mjx.errors import DatasetError, MissingFileError
from home_mjx.geometry.meshes import Z_UP, bounds, box_triangles
from home_mjx.schema.house import Fallback, Mesh

GLTF_SUFFIXES = (".glb", ".gltf")
PRIMITIVES = {  # by the start of Habitat's handles; unit sizes of Magnum, whose axis is y
    "cubesolid": lambda: box_triangles(np.zeros(3), np.ones(3)),
    "icospheresolid": lambda: sphere_triangles(1.0) @ Z_UP,
    "uvspheresolid": lambda: sphere_triangles(1.0) @ Z_UP,
    "cylindersolid": lambda: cylinder_triangles(1.0, 1.0) @ Z_UP,
    "conesolid": lambda: cone_triangles(1.0, 1.0) @ Z_UP,
    "capsule3dsolid": lambda: capsule_triangles(1.0, 0.5) @ Z_UP,
}


@dataclass
class AssetStore:
    """Assets of one house, each read once.

    Attributes:
        images: Folder that receives their images.
        strict: Whether missing images are errors.
        fallbacks: Images and material libraries that materials do without.
        notes: Elements with their properties that are not kept.
    """

    images: Path
    strict: bool
    fallbacks: list[Fallback] = field(default_factory=list)
    notes: dict[str, str] = field(default_factory=dict)
    _meshes: dict[Path, Mesh | None] = field(default_factory=dict)

    def mesh(self, path: Path) -> Mesh | None:
        """Return the meshes of a file joined in the file's frame; None if it shows nothing.

        Raises:
            MissingFileError: The file is missing.
            DatasetError: It is broken, or of another format than glTF, OBJ, STL, PLY and DAE.
        """
        if path not in self._meshes:
            placed = self.placed(path, np.eye(4))
            self._meshes[path] = join_meshes([move_mesh(p.mesh, p.matrix) for p in placed]) if placed else None
        return self._meshes[path]

    def placed(self, path: Path, frame: Matrix) -> list[PlacedMesh]:
        """Return the meshes of a file with their nodes, below a frame; errors as of `mesh`."""
        if path.suffix.lower() in PLAIN_SUFFIXES and is_file(path):
            plain = read_plain_asset(path, self.strict)
            self.fallbacks += missing_parts(plain)
            node = SceneNode("", path.name, frame)
            return [PlacedMesh(plain, path.stem[:100], (node,), path.name)] if len(plain.faces) else []
        document = open_asset(path)
        images = ImageStore(document, self.images, self.strict)
        materials = MaterialReader(document, images)
        meshes = MeshReader(document, materials)
        found = list(place_meshes(document, meshes, frame))
        self.fallbacks += [_named(fallback, path) for fallback in images.fallbacks]
        self.notes |= {f"{path.name}: {key}": note for key, note in (materials.notes | meshes.notes).items()}
        return found


def _named(fallback: Fallback, path: Path) -> Fallback:
    """Return the fallback of an image with the name of its asset before its element."""
    element = f"{path.name}: {fallback.element}"
    return Fallback(fallback.kind, fallback.name, element, fallback.replacement, fallback.reason)


def open_asset(path: Path) -> GltfDocument:
    """Return the document of a glTF file, which may have textures of KTX2; errors as of `AssetStore.mesh`."""
    if not is_file(path):
        raise MissingFileError("asset is missing", file=path, hint="Fetch it, or read without `strict`.")
    if path.suffix.lower() not in GLTF_SUFFIXES:
        hint = "Convert it to glTF, such as with Blender."
        raise DatasetError(f"assets of the format `{path.suffix[:20]}` are not read", file=path, hint=hint)
    return read_document(path, TEXTURE_EXTENSIONS)


def primitive_mesh(handle: JsonValue) -> Mesh | None:
    """Return the unit mesh of a handle of Habitat's primitives, such as `cubeSolid`; None for other names."""
    name = handle.text().lower().split("_")[0]
    if name not in PRIMITIVES:
        return None
    return plain_mesh(handle.file, PRIMITIVES[name](), GREY)


def mesh_bounds(mesh: Mesh, frame: Matrix) -> Float[np.ndarray, "2 3"]:
    """Return the minimum and maximum corner of a mesh in another frame [m]."""
    return bounds(mesh.vertices @ frame[:3, :3].T + frame[:3, 3])
