"""Meshes of a dataset: library models, parsed once each, and room meshes."""

from pathlib import Path

from home_mjx.core.files import is_file, is_folder
from home_mjx.datasets.suncg.formats.json_value import Location
from home_mjx.datasets.suncg.formats.obj import read_library_obj, read_obj
from home_mjx.datasets.suncg.formats.texture_paths import TextureLookup
from home_mjx.datasets.suncg.formats.variants import base_model
from home_mjx.errors import MissingFileError
from home_mjx.schema.house import Mesh


class AssetLibrary:
    """Meshes and textures below one dataset root.

    Args:
        root: Absolute dataset root.
        tolerant: Accept missing textures and material libraries, see `Material.missing_file`.
    """

    def __init__(self, root: Path, tolerant: bool = False) -> None:
        self.root = root
        self.tolerant = tolerant
        self.textures = TextureLookup(root, tolerant)
        self._models: dict[str, Mesh] = {}

    def model_path(self, model_id: str, key: str) -> Path:
        """Return the path of `key`.obj in the folder of the model, or of a variant's base; it may not exist."""
        objects = self.root / "object"
        folder = base_model(model_id, lambda name: name not in ("", ".", "..") and is_folder(objects / name))
        return objects / folder / f"{key}.obj"

    def model(self, model_id: str, key: str, place: Location) -> Mesh:
        """Return a library model; parse it on first use, and again if a texture or MTL that it lacked now exists.

        `model_id` is a valid file name, and `key` the stem of the OBJ: the id, or a variant. `place` is for errors.

        Raises:
            MissingFileError: The OBJ is missing.
            DatasetError: The OBJ is broken, or an error of `read_obj` in its MTL or textures.
        """
        if key not in self._models or self._has_arrived(self._models[key]):
            self._models[key] = read_library_obj(self.find_model(model_id, key, place), self.textures)
        return self._models[key]

    def _has_arrived(self, mesh: Mesh) -> bool:
        """Return whether a file that a mesh lacked when it was read now exists."""
        names = {material.missing_file for material in mesh.materials if material.missing_file}
        return any(self.textures.find(n) or (n.endswith(".mtl") and is_file(mesh.path.with_name(n))) for n in names)

    def find_model(self, model_id: str, key: str, place: Location) -> Path:
        """Return the path of an existing model's OBJ; arguments as in `model`.

        Raises:
            MissingFileError: The OBJ does not exist.
        """
        path = self.model_path(model_id, key)
        if not is_file(path):
            hint = f"Expected {path}: fetch the `object` archive of the dataset or remove the node."
            raise place.error(f"model `{key}` has no OBJ file", hint, MissingFileError)
        return path

    def mesh(self, path: Path) -> Mesh:
        """Read the OBJ at a path at every call; errors are those of `read_obj`."""
        return read_obj(path, self.textures)

    def room_path(self, house_id: str, stem: str) -> Path:
        """Return the path of the OBJ of a room or ground, such as `fr_0rm_3f` as `stem`; it may not exist."""
        return self.root / "room" / house_id / f"{stem}.obj"
