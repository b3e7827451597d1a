"""Furniture for datasets whose own models are not public, from an installed provider.

A provider is an entry point of the group `home_mjx.fallback_models` with the method `furniture`, which returns a
`FurnitureProvider`. `home_procgen` is one.
"""

import hashlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Protocol, runtime_checkable

from home_mjx.core.paths import installed
from home_mjx.errors import ConfigError
from home_mjx.schema.house import House, Joint, Joints, Light, Material, Mesh, ObjectNode

GROUP = "home_mjx.fallback_models"
Edges = tuple[float, float, float]  # [m], along x (right of the front, seen from behind), y (up), z (front)


@dataclass(frozen=True)
class FurniturePiece:
    """A model that is shown in place of another one; paths of its textures are relative.

    Attributes:
        key: Key of the mesh; equal keys have equal meshes.
        mesh: Its base around the origin, front +z, Y up [m].
        scale: Factors along the model's own axes.
        quarter: Quarter turns about +y, after scaling, to the orientation that was asked for.
        materials: Materials by slot that replace those of the mesh; empty: none.
        lights: Its lights, in the model's frame before scaling.
        words: Description, for reports.
    """

    key: str
    mesh: Mesh
    scale: Edges
    quarter: int
    materials: tuple[Material, ...]
    lights: tuple[Light, ...]
    words: str


@dataclass(frozen=True)
class DoorMesh:
    """A door on its wall's centre line, its base at y = 0, and the hinges of its leaves, 0 as shown."""

    key: str
    mesh: Mesh
    joints: tuple[Joint, ...]


@runtime_checkable
class FurnitureProvider(Protocol):
    """A source of furniture by category and size. Equal arguments always give equal results."""

    version: str  # changes whenever equal arguments would return something else
    texture_edge: float  # [m], edge of what a repeating texture covers

    def piece(self, word: str, fine: str, size: Edges | None, seed: str, shape: str = "") -> FurniturePiece | None:
        """Return a model of a category, stretched to a size; None if no model suits.

        Args:
            word: Word of the other dataset in lower case, for things that are finer than the category.
            fine: Fine category.
            size: Extents [m]; None: those of the model.
            seed: Text that selects among models and colours, such as the name of the model that is replaced.
            shape: Plan of a worktop: `I`, `L` or `C`; `wall` for what hangs on a wall.
        """
        ...

    def doors(self, width: float, height: float, leaves: int, turn: float, seed: str) -> DoorMesh:
        """Return a door of 1 or 2 leaves, opened by `turn` [rad] to -z; width and height are over its frame [m]."""
        ...

    def frame(self, width: float, height: float) -> Mesh:
        """Return the frame of a doorway, on its wall's centre line [m]."""
        ...

    def surface(self, family: str, seed: str, name: str) -> Material:
        """Return a material called `name`, with a texture of a family such as `prkt`, `tile` or `wallp`."""
        ...

    def categories(self) -> Mapping[str, tuple[str, str]]:
        """Return the coarse and the NYU40 category of the fine ones that it has."""
        ...

    def write_textures(self, root: Path, names: set[str]) -> None:
        """Write textures as `texture/<name>.png` below a folder, unless they exist.

        Raises:
            DatasetError: The folder cannot be written.
        """
        ...


@cache
def furniture_provider() -> FurnitureProvider:
    """Return the furniture of the first installed provider.

    Raises:
        ConfigError: None is installed, or it cannot be imported.
    """
    for point in installed(GROUP).values():
        try:
            provider = point.load()
        except (ImportError, AttributeError) as error:
            raise ConfigError(f"furniture of `{point.value}` cannot be loaded: {error}") from error
        if hasattr(provider, "furniture"):
            return provider.furniture()
    raise ConfigError("no installed package provides furniture", hint="Install home_mjx with home_procgen again.")


def textures_of(house: House) -> set[str]:
    """Return the names of the textures of a house whose paths are relative: those of our furniture."""
    paths = [found.texture for found in _materials(house) if found.texture is not None]
    return {path.stem for path in paths if not path.is_absolute()}


def _materials(house: House) -> Iterator[Material]:
    meshes: list[Mesh | None] = list(house.models.values())
    for level in house.levels:
        yield from (material for item in level.objects for material in item.materials)
        meshes += [mesh for room in level.rooms for mesh in (room.floor, room.ceiling, room.walls)]
    yield from (material for mesh in meshes if mesh is not None for material in mesh.materials)


def with_texture_root(house: House, root: Path) -> House:
    """Return a house whose relative paths of textures are below a folder."""

    def placed(materials: tuple[Material, ...]) -> tuple[Material, ...]:
        return tuple(m if m.texture is None else replace(m, texture=root / m.texture) for m in materials)

    def mesh(found: Mesh | None) -> Mesh | None:
        return None if found is None else replace(found, materials=placed(found.materials))

    levels = tuple(
        replace(
            level,
            objects=tuple(replace(item, materials=placed(item.materials)) for item in level.objects),
            rooms=tuple(
                replace(room, floor=mesh(room.floor), ceiling=mesh(room.ceiling), walls=mesh(room.walls))
                for room in level.rooms
            ),
        )
        for level in house.levels
    )
    models = {key: replace(found, materials=placed(found.materials)) for key, found in house.models.items()}
    return replace(house, levels=levels, models=models)


def attach_joints(house: House, joints: Joints) -> House:
    """Return the house with the joints of its models; objects that have joints already keep them.

    `joints` are those of a dataset, by model id, see `Dataset.joints`. They count for meshes with the key of their
    model, not for other variants.
    """
    levels = (replace(x, objects=tuple(_with_joints(item, joints) for item in x.objects)) for x in house.levels)
    return replace(house, levels=tuple(levels))


def _with_joints(item: ObjectNode, joints: Joints) -> ObjectNode:
    """Return an object with the joints of its model; unchanged if it has joints or its model has none."""
    own = joints.get(item.model_key, ()) if item.model_key == item.model_id and not item.joints else ()
    return replace(item, joints=own) if own else item


def hash_joints(joints: Joints) -> bytes:
    """Return a SHA-256 digest of a dataset's joints."""
    return hashlib.sha256(repr(sorted(joints.items())).encode()).digest()
