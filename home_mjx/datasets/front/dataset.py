"""A dataset of houses of 3D-FRONT: one JSON file, or those of a folder."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from home_mjx.core.files import is_folder
from home_mjx.datasets.base import DEFAULT_OPTIONS, ReadOptions
from home_mjx.datasets.front.build import MODEL_FILE, FrontBuilder
from home_mjx.datasets.front.parse import read_front
from home_mjx.datasets.furniture import furniture_provider
from home_mjx.datasets.gltf.scene_dataset import FurnishedSceneDataset, parse_options, scene_id
from home_mjx.errors import DatasetError, MissingFileError
from home_mjx.schema.house import House

FOLDER = Path(__file__).parent
MODEL_FOLDER = "3D-FUTURE-model"
NUM_HEAD_BYTES = 1 << 16  # [bytes], in which a file of 3D-FRONT has its first key
OPTIONS_HINT = "The option is `models=FOLDER`, such as `front:3D-FRONT?models=3D-FUTURE-model`."


@dataclass(frozen=True)
class FrontOptions:
    """Options of reading 3D-FRONT.

    Attributes:
        models: Folder of 3D-FUTURE's models; "": `3D-FUTURE-model` beside the houses, if it exists.
    """

    models: str = ""


def holds_front(path: Path) -> bool:
    """Return whether a path is a house of 3D-FRONT by its first keys, or a folder whose first JSON file is one."""
    if is_folder(path):
        first = min(path.glob("*.json"), default=None)
        return first is not None and holds_front(first)
    if path.suffix.lower() != ".json" or not path.is_file():
        return False
    with path.open("rb") as file:
        head = file.read(NUM_HEAD_BYTES)
    return b'"north_vector"' in head or (b'"furniture"' in head and b'"jid"' in head)


class FrontDataset(FurnishedSceneDataset):
    """Houses of 3D-FRONT.

    `root` is the folder in the cache that receives textures of our furniture.

    Args:
        text: Path of a house or of a folder of houses, `PATH` or `PATH?models=FOLDER`.

    Raises:
        ConfigError: An option is unknown.
        MissingFileError: The path does not exist, or the folder holds no house.

    Example:
        >>> dataset = open_dataset("front:3D-FRONT?models=3D-FUTURE-model")  # doctest: +SKIP
    """

    recognizes: ClassVar[Callable[[Path], bool]] = staticmethod(holds_front)
    scheme = "front"
    no_scene = "folder contains no JSON file of 3D-FRONT"
    code = (
        FOLDER,
        FOLDER.with_name("gltf"),
        FOLDER.with_name("habitat") / "semantics.py",
        FOLDER.with_name("habitat") / "stand_ins.py",
        FOLDER.with_name("taxonomy.csv"),
        FOLDER.with_name("taxonomy.py"),
    )

    def read_options(self, query: str) -> FrontOptions:
        """Return the options of a name's query."""
        return parse_options(FrontOptions, query, OPTIONS_HINT)

    def find_scenes(self) -> Mapping[str, Path]:
        """Return the files of the houses by id: their stems, sorted."""
        files = sorted(self.path.glob("*.json")) if self.path.is_dir() else [self.path]
        return {scene_id(file.stem): file for file in files}

    @property
    def models(self) -> Path | None:
        """Folder of 3D-FUTURE's models; None if there is none.

        Raises:
            MissingFileError: The stated folder does not exist.
        """
        if self.options.models:
            stated = Path(self.options.models).expanduser().absolute()
            if not is_folder(stated):
                raise MissingFileError("folder of models does not exist", file=stated, hint=OPTIONS_HINT)
            return stated
        folder = self.path if self.path.is_dir() else self.path.parent
        near = [folder / MODEL_FOLDER, folder.parent / MODEL_FOLDER]
        return next((found for found in near if is_folder(found)), None)

    def load_house(self, house_id: str, options: ReadOptions = DEFAULT_OPTIONS) -> House:
        """Read one house.

        Args:
            house_id: One of `house_ids`.
            options: Categories to leave out; if strict, missing models are errors.

        Raises:
            UnknownIdError: No house has this id.
            DatasetError: The house or a model is broken.
        """
        self.check_known(house_id)
        path = self.scenes[house_id]
        builder = FrontBuilder(read_front(path), path, self.models, furniture_provider(), options)
        house = builder.build(house_id, self.wanted)
        return self.store_textures(house)

    def scene_files(self, house_id: str) -> list[Path]:
        """Return the files of a house: itself, and the models that it names with their materials."""
        path, folder = self.scenes[house_id], self.models
        try:
            names = sorted({piece.model for piece in read_front(path).pieces.values()}) if folder is not None else []
        except DatasetError:
            names = []
        files = [folder / name / file for name in names for file in (MODEL_FILE, "model.mtl") if folder is not None]
        return [path, *files]
