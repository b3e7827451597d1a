"""Assets without nodes: OBJ files with their materials, and STL files."""

import io
from pathlib import Path

import numpy as np

from home_mjx.core.files import read_bytes, resolve_below
from home_mjx.datasets.shapes import Triangles
from home_mjx.datasets.suncg.formats.json_value import MAX_COORDINATE, printable
from home_mjx.datasets.suncg.formats.obj import read_library_obj
from home_mjx.datasets.suncg.formats.statements import library_names, split_statements
from home_mjx.datasets.suncg.formats.texture_paths import TextureLookup
from home_mjx.errors import DatasetError
from home_mjx.schema.house import Fallback, Material, Mesh

OBJ, STL = ".obj", ".stl"
PLAIN_SUFFIXES = (OBJ, STL)
GREY = Material("grey", (0.6, 0.6, 0.6), None, 1.0)
MAX_STL_BYTES = 1 << 28  # [bytes]


def read_plain_asset(path: Path, strict: bool) -> Mesh:
    """Return the mesh of an OBJ or STL file; materials and images of an OBJ must be in its folder.

    Args:
        path: The file.
        strict: Whether missing materials and images are errors.

    Raises:
        DatasetError: The file is broken or, if strict, lacks a material or an image.
    """
    if path.suffix.lower() == OBJ:
        return read_library_obj(path, TextureLookup(path.parent, tolerant=not strict))
    return plain_mesh(path, _stl_triangles(path), GREY)


def plain_mesh(path: Path, triangles: Triangles, material: Material) -> Mesh:
    """Return triangles as a mesh of one material, without texture coordinates."""
    count = len(triangles)
    return Mesh(
        path=path,
        vertices=triangles.reshape(-1, 3),
        faces=np.arange(3 * count).reshape(-1, 3),
        uv=np.zeros((count, 3, 2)),
        slot=np.zeros(count, int),
        group=np.full(count, -1),
        materials=(material,),
    )


def missing_parts(mesh: Mesh) -> list[Fallback]:
    """Return the material libraries and images that a mesh of an OBJ file does without, each once."""
    found = {}
    for name in dict.fromkeys(material.missing_file for material in mesh.materials if material.missing_file):
        kind, taken = ("material library", "grey") if name.endswith(".mtl") else ("texture", "the material's colour")
        found[name] = Fallback(kind, name, mesh.path.name, taken, "missing")
    return list(found.values())


def library_paths(path: Path) -> list[Path]:
    """Return the files that the `mtllib` lines of an OBJ file may mean, without those out of its folder.

    None if the file cannot be read, which is an error where its mesh is read.
    """
    try:
        text = read_bytes(path).decode(errors="replace")
    except DatasetError:
        return []
    named = [rest for _, keyword, rest in split_statements(text) if keyword == "mtllib"]
    texts = dict.fromkeys(name.replace("\\", "/") for line in named for name in library_names(line.rstrip()))
    found = (resolve_below(path.parent, path.parent, name) for name in texts if name and "\0" not in name)
    return [library for library in found if library is not None]


def _stl_triangles(path: Path) -> np.ndarray:
    """Return the triangles of an STL file, (t, 3, 3)."""
    import trimesh

    data = read_bytes(path, max_bytes=MAX_STL_BYTES)
    try:
        found = trimesh.load_mesh(io.BytesIO(data), file_type="stl", process=False).triangles
    except Exception as error:  # trimesh raises errors of any type
        reason = printable(str(error)[:100])
        raise DatasetError(f"not an STL file: {reason}", file=path, hint="Fetch or export it again.") from None
    triangles = np.asarray(found, float).reshape(-1, 3, 3)
    if not len(triangles):
        raise DatasetError("STL file has no triangles", file=path, hint="Fetch or export it again.")
    if not (abs(triangles) <= MAX_COORDINATE).all():
        raise DatasetError("coordinates are not finite, or beyond 1,000 km", file=path, hint="Export it again.")
    return triangles
