"""Rules on material slots and textures."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from home_mjx.core.files import read_bytes
from home_mjx.core.images import open_texture
from home_mjx.datasets.suncg.formats.obj import DEFAULT_MATERIAL
from home_mjx.datasets.suncg.validate.context import ValidationContext
from home_mjx.errors import DatasetError
from home_mjx.schema.house import Material, Mesh

EXTENSIONS_BY_MAGIC = {
    b"\x89PNG": (".png",),
    b"\xff\xd8\xff": (".jpg", ".jpeg"),
}  # extensions by the first bytes of a file


def check_materials(subject: ValidationContext) -> None:
    """Report slots without faces, faces without slots, and textures that do not decode or have a wrong extension."""
    meshes = {mesh.path: mesh for mesh in subject.reading.results.values() if isinstance(mesh, Mesh)}
    for mesh in (mesh for path, mesh in meshes.items() if path.suffix == ".obj"):
        _check_slots(subject, mesh)
    for texture in sorted({m.texture for m in _materials(subject) if m.texture}):
        _check_texture(subject, texture)


def _materials(subject: ValidationContext) -> Iterator[Material]:
    """Yield the materials of overrides, rooms, grounds and models; some repeatedly."""
    for level in subject.house.levels:
        for node in (*level.objects, *level.boxes):
            yield from node.materials
        for mesh in (part for room in level.rooms for part in (room.floor, room.ceiling, room.walls)):
            yield from () if mesh is None else mesh.materials
        for ground in level.grounds:
            yield from () if ground.mesh is None else ground.mesh.materials
    for mesh in subject.house.models.values():
        yield from mesh.materials


def _check_slots(subject: ValidationContext, mesh: Mesh) -> None:
    """Report slots without faces, and faces above the first `usemtl`."""
    if mesh.materials[-1] is DEFAULT_MATERIAL:
        count = int((mesh.slot == len(mesh.materials) - 1).sum())
        subject.report("missing-slot", "", f"{count} faces have no `usemtl` above them", mesh.path)
    used = set(np.unique(mesh.slot).tolist())
    unused = [material.name for slot, material in enumerate(mesh.materials) if slot not in used]
    if unused:
        subject.report("unused-slot", ", ".join(unused), "no face is of this material", mesh.path)


def _check_texture(subject: ValidationContext, path: Path) -> None:
    """Report an image that does not decode, or whose extension does not match its content."""
    try:
        open_texture(path)
    except DatasetError as error:
        subject.report("texture-broken", "", error.message, path)
        return
    start = read_bytes(path)[:4]
    fitting = next(extensions for magic, extensions in EXTENSIONS_BY_MAGIC.items() if start.startswith(magic))
    if path.suffix.lower() not in fitting:
        subject.report("texture-type", "", f"expected the extension {fitting[0]} for the file's content", path)
