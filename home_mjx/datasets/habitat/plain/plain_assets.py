"""Assets without nodes: OBJ files with their materials, and files of STL, PLY and COLLADA (DAE)."""

import io
import logging
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from home_mjx.core.color import decode_srgb, encode_srgb
from home_mjx.core.files import read_bytes, resolve_below
from home_mjx.datasets.gltf.decode.primitives import round_colors
from home_mjx.datasets.gltf.scene_lights import to_vector
from home_mjx.datasets.habitat.plain.collada import collada_frame
from home_mjx.datasets.habitat.plain.ply import read_ply
from home_mjx.datasets.habitat.plain.stl import FETCH, read_stl
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
    """Return the mesh of an STL, PLY or DAE file."""
    data = read_bytes(path, max_bytes=MAX_LOADED_BYTES)
    triangles, linear = _read_triangles(path, data)
    if not len(triangles):
        raise DatasetError("file has no triangles", file=path, hint=FETCH)
    if not (abs(triangles) <= MAX_COORDINATE).all():
        raise DatasetError("coordinates are not finite, or beyond 1,000 km", file=path, hint="Export it again.")
    if linear is None:
        return plain_mesh(path, triangles, GREY)
    slot, shades = round_colors(linear)
    names = (to_vector(np.round(encode_srgb(np.clip(shade, 0, 1)), 6)) for shade in shades)
    mesh = plain_mesh(path, triangles, GREY)
    return replace(mesh, slot=slot, materials=tuple(Material("color", shade, None, 1.0) for shade in names))


def _read_triangles(path: Path, data: bytes) -> tuple[Triangles, Float[np.ndarray, "t 3"] | None]:
    """Return the triangles of an STL, PLY or DAE file, and their linear colours, if it states any."""
    kind = path.suffix.lower()
    if kind == ".stl":
        return read_stl(path, data), None
    return read_ply(path, data) if kind == ".ply" else _load_collada(path, data)


def _load_collada(path: Path, data: bytes) -> tuple[Triangles, Float[np.ndarray, "t 3"] | None]:
    """Return the triangles of a DAE file as trimesh reads it, in metres and y up, and their linear colours."""
    parts = _load_parts(path, data)
    if not parts:
        return np.zeros((0, 3, 3)), None
    triangles = np.concatenate([np.asarray(part.triangles, float).reshape(-1, 3, 3) for part in parts])
    colors = [_face_colors(part) for part in parts]
    if all(color is None for color in colors):
        return triangles, None
    grey = decode_srgb(np.array(GREY.diffuse))
    rows = zip(parts, colors, strict=True)
    return triangles, np.concatenate([np.tile(grey, (len(p.faces), 1)) if c is None else c for p, c in rows])


def _load_parts(path: Path, data: bytes) -> list[Any]:
    """Return the meshes of a DAE file as objects of trimesh, in metres and y up."""
    import trimesh

    frame = collada_frame(path, data)
    try:
        with _without_log():
            scene = trimesh.load_scene(io.BytesIO(data), file_type="dae", process=False)
        if scene.geometry:
            scene.apply_transform(frame)
        return [part for part in scene.dump() if isinstance(part, trimesh.Trimesh) and len(part.faces)]
    except ImportError:
        raise DatasetError("DAE files need pycollada", file=path, hint=install_hint("dae")) from None
    except Exception as error:  # trimesh raises errors of any type
        raise DatasetError(f"not a file of DAE: {printable(str(error)[:100])}", file=path, hint=FETCH) from None


@contextmanager
def _without_log() -> Iterator[None]:
    """Silence trimesh, which logs the traceback of each image that it does not load."""
    log = logging.getLogger("trimesh")
    level = log.level
    log.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        log.setLevel(level)


def _face_colors(part: Any) -> Float[np.ndarray, "f 3"] | None:
    """Return the linear colour of each face of a mesh of trimesh; None if it states none."""
    if part.visual.kind == "vertex":
        return decode_srgb(np.asarray(part.visual.vertex_colors)[:, :3] / 255)[part.faces].mean(axis=1)
    if part.visual.kind == "face":
        return decode_srgb(np.asarray(part.visual.face_colors)[:, :3] / 255)
    color = getattr(getattr(part.visual, "material", None), "main_color", None)
    return None if color is None else np.tile(decode_srgb(np.asarray(color)[:3] / 255), (len(part.faces), 1))
