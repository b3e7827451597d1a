"""Export of a compiled house as a Habitat scene dataset: stage, objects, doors, semantics and lights."""

import hashlib
import json
from pathlib import Path
from typing import Any

from home_mjx.core.files import convert_write_errors, write_atomically
from home_mjx.errors import ConfigError
from home_mjx.scene_compile.gltf.assets import GltfAssets
from home_mjx.scene_compile.gltf.document import DocumentWriter
from home_mjx.scene_compile.gltf.export import placement
from home_mjx.scene_compile.gltf.habitat_configs import (
    DATASET,
    FRAME,
    door_urdf,
    lighting_config,
    semantic_config,
    semantic_id,
    to_place,
)
from home_mjx.schema.categories import FINE
from home_mjx.schema.compiled import ARCHITECTURE, CompiledHouse
from home_mjx.schema.semantic import Semantic

CONFIG = "home_mjx.scene_dataset_config.json"
DIGITS = 12  # hexadecimal digits of digests in file names


def export_habitat(house: CompiledHouse, folder: Path) -> Path:
    """Write a house into a folder as a scene of a Habitat dataset, and return the dataset's configuration.

    Several houses may share a folder, and then share the files of equal objects. The frame is that of `to_glb`: metres,
    y up, (x, z, -y) of the world. Objects are placed by their assets' origins. Doors with leaves that move are URDF
    files, whose joint value 0 is closed. Objects of unknown category that do not move are part of the stage.

    Raises:
        ConfigError: `folder` is a file, or cannot be written.
        DatasetError: A texture cannot be read.

    Example:
        >>> export_habitat(house, Path("flats")).name  # doctest: +SKIP
        'home_mjx.scene_dataset_config.json'
    """
    folder = Path(folder)
    if folder.exists() and not folder.is_dir():
        raise ConfigError("a Habitat dataset is a folder, this is a file", file=folder, hint="Name a folder.")
    with convert_write_errors("Habitat dataset", folder):
        _SceneWriter(house, folder).write()
    return folder / CONFIG


class _SceneWriter:
    """Writer of the files of one house."""

    def __init__(self, house: CompiledHouse, folder: Path) -> None:
        self._house, self._folder = house, folder
        self._names: dict[tuple[str, int], str] = {}

    def write(self) -> None:
        """Write all files; the scene and the dataset's configuration last."""
        house = self._house
        stage, rest = self._split()
        self._write("stages", f"{house.id}.glb", self._stage_glb(stage))
        self._write_json("stages", f"{house.id}.stage_config.json", {"render_asset": f"{house.id}.glb", **FRAME})
        doors = self._door_groups(rest)
        moving = {instance for group in doors for instance in group}
        scene = {
            "stage_instance": {"template_name": f"stages/{house.id}", "translation_origin": "asset_local"},
            "translation_origin": "asset_local",
            "default_lighting": f"lights/{house.id}",
            "semantic_scene_instance": f"semantics/{house.id}",
            "object_instances": [self._object(instance) for instance in rest if instance not in moving],
            "articulated_object_instances": [self._door(group) for group in doors],
        }
        self._write_json("semantics", f"{house.id}.semantic_config.json", semantic_config(house))
        self._write_json("lights", f"{house.id}.lighting_config.json", lighting_config(house))
        self._write_json("scenes", f"{house.id}.scene_instance.json", scene)
        self._write_json("", CONFIG, DATASET)

    def _split(self) -> tuple[list[int], list[int]]:
        """Return the instances of the stage, and those of the objects."""
        movable = {*self._house.bodies.instance.tolist(), *self._house.doors.instance.tolist()}
        everything = range(len(self._house.instances.model))
        stage = [i for i in everything if i == ARCHITECTURE or (i not in movable and not self._category(i))]
        return stage, [i for i in everything if i not in set(stage)]

    def _category(self, instance: int) -> str:
        """Return the fine category of an instance; "" if it is unknown."""
        fine = self._fine(instance)
        return FINE[fine] if fine >= 0 and FINE[fine] not in ("unknown", "empty") else ""

    def _fine(self, instance: int) -> int:
        """Return the index of the fine category of an instance; -1 if unknown."""
        table = self._house
        return int(table.semantics[table.instances.semantic[instance], Semantic.FINE])

    def _stage_glb(self, instances: list[int]) -> bytes:
        """Return the architecture and all fixed things of unknown category as a GLB file."""
        document = DocumentWriter()
        assets, nodes = GltfAssets(self._house, document), []
        for instance in instances:
            node = {"name": f"stage{instance}", "mesh": self._mesh(assets, instance)}
            node |= placement(self._house.instances.pose[instance].astype(float))
            nodes.append(document.add("nodes", node))
        document.root |= {"scene": 0, "scenes": [{"name": self._house.id, "nodes": nodes}]}
        return document.glb()

    def _mesh(self, assets: GltfAssets, instance: int) -> int:
        """Return the mesh of an instance in the document of `assets`."""
        table = self._house.instances
        return assets.mesh(self._house.models[table.model[instance]], int(table.material[instance]))

    def _model(self, instance: int) -> str:
        """Write the GLB and the configuration of an instance's model and materials, and return their name."""
        table = self._house.instances
        key = table.model[instance], int(table.material[instance])
        if key not in self._names:
            document = DocumentWriter()
            mesh = self._mesh(GltfAssets(self._house, document), instance)
            node = document.add("nodes", {"name": self._category(instance) or "object", "mesh": mesh})
            document.root |= {"scene": 0, "scenes": [{"nodes": [node]}]}
            data = document.glb()
            name = f"{self._category(instance) or 'object'}_{hashlib.sha256(data).hexdigest()[:DIGITS]}"
            config = {"render_asset": f"{name}.glb", "COM": [0, 0, 0], "semantic_id": semantic_id(self._fine(instance))}
            self._write("objects", f"{name}.glb", data)
            self._write_json("objects", f"{name}.object_config.json", {**config, **FRAME})
            self._names[key] = name
        return self._names[key]

    def _object(self, instance: int) -> dict[str, Any]:
        """Return an instance of a rigid object; only movable ones are dynamic."""
        is_movable = instance in self._house.bodies.instance
        place = to_place(self._house.instances.pose[instance])
        motion = "DYNAMIC" if is_movable else "STATIC"
        return {"template_name": f"objects/{self._model(instance)}", "motion_type": motion, **place}

    def _door_groups(self, instances: list[int]) -> list[list[int]]:
        """Return the instances of each door with leaves that move: frame and leaves."""
        owner = self._house.instances.object_id
        moving = {int(owner[i]) for i in self._house.doors.instance}
        return [[i for i in instances if owner[i] == door] for door in sorted(moving)]

    def _door(self, group: list[int]) -> dict[str, Any]:
        """Write a door as URDF, and return its instance."""
        owner = int(self._house.instances.object_id[group[0]])
        name = f"{self._category(group[0]) or 'door'}_{self._house.id}_{owner}"
        text, place, shown = door_urdf(self._house, name, {i: f"../objects/{self._model(i)}.glb" for i in group})
        self._write("urdf", f"{name}.urdf", text.encode())
        instance: dict[str, Any] = {"template_name": f"urdf/{name}", "translation": place, "fixed_base": True}
        return instance | {"initial_joint_pose": shown, "motion_type": "DYNAMIC"}

    def _write_json(self, folder: str, name: str, content: dict[str, Any]) -> None:
        """Write a JSON file."""
        self._write(folder, name, json.dumps(content, indent=1, allow_nan=False, default=_plain).encode())

    def _write(self, folder: str, name: str, data: bytes) -> None:
        """Write a file."""
        with write_atomically(self._folder / folder / name) as file:
            file.write(data)


def _plain(value: Any) -> Any:
    """Return a NumPy number as one of Python."""
    return value.item()
