"""A house of 3D-FRONT: architecture from its meshes, rooms from their floors, furniture from 3D-FUTURE."""

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from home_mjx.core.files import is_file
from home_mjx.datasets.base import ReadOptions
from home_mjx.datasets.front.parse import FrontHouse, FrontInstance, FrontPiece, FrontRoom, faces_up
from home_mjx.datasets.furniture import FurnitureProvider
from home_mjx.datasets.gltf.house import HouseParts, SceneObject
from home_mjx.datasets.gltf.layout.room_file import StatedRoom
from home_mjx.datasets.gltf.layout.room_search import is_outline
from home_mjx.datasets.gltf.layout.rooms import find_rooms
from home_mjx.datasets.gltf.layout.triangle_set import TriangleSet, concat_triangles
from home_mjx.datasets.gltf.objects import MeshObject
from home_mjx.datasets.gltf.scene_dataset import MAX_NOTES
from home_mjx.datasets.habitat.semantics import stack_rooms
from home_mjx.datasets.habitat.stand_ins import stand_in
from home_mjx.datasets.suncg.formats.obj import read_library_obj
from home_mjx.datasets.suncg.formats.texture_paths import TextureLookup
from home_mjx.datasets.taxonomy import UNKNOWN, fine_category
from home_mjx.errors import DatasetError, MissingFileError
from home_mjx.geometry.meshes import bounds, to_z_up
from home_mjx.geometry.polygons import outline
from home_mjx.schema.house import Fallback, House, Material, Mesh, Problem

MODEL_FILE = "raw_model.obj"
OPENINGS = ("Door", "Hole", "Pocket")  # types of meshes that are left out, so that doorways are open
WINDOWS = ("Window",)
MAX_SHARE = 1.05  # of the extent of the house, that a piece of furniture may have
ROOM_TYPES = {
    **dict.fromkeys(("MasterBedroom", "SecondBedroom", "Bedroom"), "Bedroom"),
    **dict.fromkeys(("LivingRoom", "LivingDiningRoom", "Lounge"), "Living_Room"),
    **dict.fromkeys(("Bathroom", "MasterBathroom", "SecondBathroom"), "Bathroom"),
    **dict.fromkeys(("Hallway", "Corridor", "Aisle", "StairWell"), "Hallway"),
    **dict.fromkeys(("StorageRoom", "LaundryRoom"), "Storage"),
    **dict.fromkeys(("Auditorium", "EquipmentRoom", "NannyRoom", "OtherRoom", "Courtyard"), "Room"),
    **{"KidsRoom": "Child_Room", "ElderlyRoom": "Guest_Room", "DiningRoom": "Dining_Room", "Kitchen": "Kitchen"},
    **{"Balcony": "Balcony", "Library": "Office", "CloakRoom": "Wardrobe", "Terrace": "Terrace", "Garage": "Garage"},
}
Wanted = Callable[[Iterable[SceneObject], ReadOptions], Sequence[SceneObject]]


@dataclass
class FrontBuilder:
    """Builder of one house.

    Attributes:
        house: The house in the file.
        path: The file.
        models: Folder of 3D-FUTURE's models; None: our own furniture replaces all.
        provider: Our furniture.
        options: Parts to read, and whether missing models are errors.
        problems: Irregularities, and what is left out.
        fallbacks: Our furniture in place of missing models.
    """

    house: FrontHouse
    path: Path
    models: Path | None
    provider: FurnitureProvider
    options: ReadOptions
    problems: list[Problem] = field(default_factory=list)
    fallbacks: list[Fallback] = field(default_factory=list)

    def build(self, house_id: str, wanted: Wanted) -> House:
        """Return the house; textures of our furniture have relative paths.

        Raises:
            DatasetError: No room has a floor, or a model is broken or, if strict, missing.
        """
        stated = stack_rooms(self._rooms())
        if not stated:
            raise DatasetError("house has no room with a floor", file=self.path, element="scene.room")
        triangles, windows = self._architecture()
        rooms = find_rooms(triangles, stated, False)
        parts = HouseParts(self.path, rooms)
        objects = wanted([*windows, *self._furniture(triangles)], self.options)
        levels = parts.levels(triangles, objects)
        if self.house.num_invalid:
            self.problems.append(Problem("furniture", f"{self.house.num_invalid} pieces are not marked as valid"))
        known = self.house.meshes.keys() | self.house.pieces.keys()
        lost = sum(child.ref not in known for room in self.house.rooms for child in room.children)
        if lost:
            self.problems.append(Problem("scene.room", f"{lost} instances name no mesh or valid piece: left out"))
        problems, fallbacks = tuple(self.problems[:MAX_NOTES]), tuple(self.fallbacks)
        return House(house_id, "3D-FRONT", self.path, levels, parts.models, problems, fallbacks=fallbacks)

    def _rooms(self) -> Iterator[StatedRoom]:
        """Yield the rooms that have a floor, with the outline of its triangles."""
        for room in self.house.rooms:
            floors = [t for child, t, kind in self._meshes(room) if kind == "Floor" and len(t)]
            corners = _outline(np.concatenate(floors)) if floors else np.zeros((0, 2))
            if not is_outline(corners):
                self.problems.append(Problem(room.element, "room has no floor: it is no room here"))
                continue
            floor = float(np.concatenate(floors)[..., 1].max())
            yield StatedRoom(corners, ROOM_TYPES.get(room.type, ""), 0, floor, None)

    def _meshes(self, room: FrontRoom) -> Iterator[tuple[FrontInstance, np.ndarray, str]]:
        """Yield the instances of meshes in a room, with their triangles in the house and their type."""
        for child in room.children:
            mesh = self.house.meshes.get(child.ref)
            if mesh is not None:
                corners = (mesh.triangles * child.scale) @ child.matrix[:3, :3].T + child.matrix[:3, 3]
                yield child, corners, mesh.kind

    def _architecture(self) -> tuple[TriangleSet, list[MeshObject]]:
        """Return the triangles of the building, each mesh once, and its windows as objects."""
        slots: dict[Material, int] = {}
        parts: list[TriangleSet] = []
        windows: list[MeshObject] = []
        seen: set[str] = set()
        left_out: Counter[str] = Counter()
        for room in self.house.rooms:
            for child, corners, kind in self._meshes(room):
                mesh = self.house.meshes[child.ref]
                if child.ref in seen or not len(corners):
                    continue
                seen.add(child.ref)
                own = TriangleSet(corners, mesh.uv, np.zeros(len(corners), int), (mesh.material,))
                if kind in OPENINGS:
                    left_out[kind] += 1
                elif kind in WINDOWS:
                    windows.append(_window(own, self.path, len(windows), kind))
                else:
                    slot = slots.setdefault(mesh.material, len(slots))
                    parts.append(TriangleSet(corners, mesh.uv, np.full(len(corners), slot), ()))
        for kind, count in sorted(left_out.items()):
            self.problems.append(Problem("mesh", f"{count} meshes of the type `{kind}` are left out"))
        if not parts:
            raise DatasetError("house has no meshes in its rooms", file=self.path, element="mesh")
        joined = concat_triangles(parts)
        return TriangleSet(joined.corners, joined.uv, joined.slot, tuple(slots)), windows

    def _furniture(self, building: TriangleSet) -> Iterator[MeshObject]:
        """Yield the furniture of all rooms."""
        most = MAX_SHARE * float(np.ptp(building.corners.reshape(-1, 3), axis=0).max())
        for room in self.house.rooms:
            for child in room.children:
                piece = self.house.pieces.get(child.ref)
                if piece is None:
                    continue
                if (child.scale <= 0).any():
                    self.problems.append(Problem(child.element, "scale is not positive: left out"))
                    continue
                found = self._piece(child, piece)
                if np.ptp(found.points, axis=0).max() > most:
                    self.problems.append(Problem(child.element, "piece is larger than the house: left out"))
                else:
                    yield found

    def _piece(self, child: FrontInstance, piece: FrontPiece) -> MeshObject:
        """Return a piece of furniture, by its model or our own one of its category and size."""
        fine = next((f for word in piece.words if (f := fine_category("future3d", word)) != UNKNOWN), UNKNOWN)
        place = child.matrix @ np.diag([*child.scale, 1.0])
        extra = {"name": piece.model, "category": piece.words[0] if piece.words else ""}
        path = self.models / piece.model / MODEL_FILE if self.models is not None else None
        if path is not None and self.models is not None and is_file(path):
            mesh = read_library_obj(path, TextureLookup(self.models, tolerant=not self.options.strict))
            return MeshObject(fine, f"{fine}_{piece.model}", place, mesh, (), extra)
        if self.options.strict:
            raise MissingFileError(
                f"model `{piece.model}` is missing", file=path or self.path, element=child.element,
                hint="Name the folder of 3D-FUTURE's models by `?models=FOLDER`.",
            )  # fmt: skip
        key, mesh, matrix, words = stand_in(self.provider, fine, piece.box, piece.model)
        self.fallbacks.append(Fallback("model", piece.model, child.element, words, "model of 3D-FUTURE is missing"))
        return MeshObject(fine, f"{fine}_{key}", place @ matrix, mesh, (), extra)


def _outline(triangles: np.ndarray) -> np.ndarray:
    """Return the outline (x, z) of a floor."""
    return outline(to_z_up(faces_up(triangles))) * [1.0, -1.0]


def _window(triangles: TriangleSet, path: Path, number: int, kind: str) -> MeshObject:
    """Return a window around the middle of its box."""
    matrix = np.eye(4)
    matrix[:3, 3] = bounds(triangles.corners).mean(axis=0)
    moved = TriangleSet(triangles.corners - matrix[:3, 3], triangles.uv, triangles.slot, triangles.materials)
    mesh: Mesh = moved.mesh(path)
    return MeshObject("window", f"window_{number}", matrix, mesh, (), {"name": f"{kind}_{number}", "category": kind})
