"""Assets without nodes: OBJ files with their materials, and files of STL, PLY and COLLADA (DAE)."""

import io
import re
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from home_mjx.core.color import decode_srgb, encode_srgb
from home_mjx.core.files import read_bytes, resolve_below
from home_mjx.datasets.gltf.decode.primitives import round_colors
from home_mjx.datasets.gltf.scene_lights import to_vector
from home_mjx.datasets.shapes import Triangles
from home_mjx.datasets.suncg.formats.json_value import MAX_COORDINATE, printable
from home_mjx.datasets.suncg.formats.mtl import read_mtl
from home_mjx.datasets.suncg.formats.obj import read_library_obj
from home_mjx.datasets.suncg.formats.statements import library_names, split_statements
from home_mjx.datasets.suncg.formats.texture_paths import TextureLookup
from home_mjx.errors import DatasetError, install_hint
from home_mjx.schema.house import Fallback, Material, Mesh

OBJ = ".obj"
PLAIN_SUFFIXES = (OBJ, ".stl", ".ply", ".dae")
FETCH = "Fetch or export it again."
UP_AXIS = re.compile(rb"<up_axis>\s*([XYZ])_UP")
UNIT = re.compile(rb"<unit\b[^>]*\bmeter\s*=\s*[\"']([0-9.]{1,20}(?:[eE][+-]?[0-9]{1,2})?)[\"']")
ENTITY = re.compile(rb"<!ENTITY|<!DOCTYPE", re.IGNORECASE)
GREY = Material("grey", (0.6, 0.6, 0.6), None, 1.0)
MAX_LOADED_BYTES = 1 << 28  # [bytes]


def read_plain_asset(path: Path, strict: bool) -> Mesh:
    """Return the mesh of an OBJ, STL, PLY or DAE file; materials and images of an OBJ must be in its folder.

    PLY and DAE have colours, but no images.

    Args:
        path: The file.
        strict: Whether missing materials and images are errors.

    Raises:
        DatasetError: The file is broken or, if strict, lacks a material or an image.
    """
    if path.suffix.lower() == OBJ:
        return read_library_obj(path, TextureLookup(path.parent, tolerant=not strict))
    return _loaded_mesh(path)


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


def image_paths(libraries: Iterable[Path]) -> list[Path]:
    """Return the colour maps that material libraries name, those that exist in the folders of the libraries."""
    found: dict[Path, None] = {}
    for library in libraries:
        try:
            materials = read_mtl(library, TextureLookup(library.parent, tolerant=True))
        except DatasetError:
            continue
        found.update((one.texture, None) for one in materials if one.texture is not None)
    return list(found)


def _loaded_mesh(path: Path) -> Mesh:
    """Return the mesh of an STL, PLY or DAE file as trimesh reads it."""
    parts = _load_parts(path)
    triangles = np.concatenate([np.asarray(part.triangles, float).reshape(-1, 3, 3) for part in parts])
    if not len(triangles):
        raise DatasetError("file has no triangles", file=path, hint=FETCH)
    if not (abs(triangles) <= MAX_COORDINATE).all():
        raise DatasetError("coordinates are not finite, or beyond 1,000 km", file=path, hint="Export it again.")
    colors = [_face_colors(part) for part in parts]
    if all(color is None for color in colors):
        return plain_mesh(path, triangles, GREY)
    grey = decode_srgb(np.array(GREY.diffuse))
    rows = zip(parts, colors, strict=True)
    linear = np.concatenate([np.tile(grey, (len(p.faces), 1)) if c is None else c for p, c in rows])
    slot, shades = round_colors(linear)
    names = (to_vector(np.round(encode_srgb(np.clip(shade, 0, 1)), 6)) for shade in shades)
    mesh = plain_mesh(path, triangles, GREY)
    return replace(mesh, slot=slot, materials=tuple(Material("color", shade, None, 1.0) for shade in names))


def _load_parts(path: Path) -> list[Any]:
    """Return the meshes of a file as objects of trimesh, in metres and y up where the file tells its axes."""
    import trimesh

    kind, data = path.suffix.lower()[1:], read_bytes(path, max_bytes=MAX_LOADED_BYTES)
    if kind == "dae" and ENTITY.search(data):
        raise DatasetError("file declares entities", file=path, hint="Export it again.")
    try:
        scene = trimesh.load_scene(io.BytesIO(data), file_type=kind, process=False)
        if kind == "dae":
            scene.apply_transform(_dae_frame(data))
        return [part for part in scene.dump() if isinstance(part, trimesh.Trimesh) and len(part.faces)]
    except ImportError:
        raise DatasetError("DAE files need pycollada", file=path, hint=install_hint("dae")) from None
    except Exception as error:  # trimesh raises errors of any type
        reason = printable(str(error)[:100])
        raise DatasetError(f"not a file of {kind.upper()}: {reason}", file=path, hint=FETCH) from None


def _dae_frame(data: bytes) -> Float[np.ndarray, "4 4"]:
    """Return the transform of a COLLADA document to metres and y up."""
    axis, unit = UP_AXIS.search(data), UNIT.search(data)
    matrix = np.eye(4)
    if axis is not None and axis[1] != b"Y":
        matrix[:3, :3] = {b"Z": [[1, 0, 0], [0, 0, 1], [0, -1, 0]], b"X": [[0, -1, 0], [1, 0, 0], [0, 0, 1]]}[axis[1]]
    matrix[:3] *= float(unit[1]) if unit is not None else 1.0
    return matrix


def _face_colors(part: Any) -> Float[np.ndarray, "f 3"] | None:
    """Return the linear colour of each face of a mesh of trimesh; None if it states none."""
    if part.visual.kind == "vertex":
        return decode_srgb(np.asarray(part.visual.vertex_colors)[:, :3] / 255)[part.faces].mean(axis=1)
    if part.visual.kind == "face":
        return decode_srgb(np.asarray(part.visual.face_colors)[:, :3] / 255)
    color = getattr(getattr(part.visual, "material", None), "main_color", None)
    return None if color is None else np.tile(decode_srgb(np.asarray(color)[:3] / 255), (len(part.faces), 1))
