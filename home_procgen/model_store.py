"""Shipped library of furniture models at both levels of detail, built once by `home_procgen.build_library`."""

from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Any

from home_mjx.core.array_store import READ_ERRORS, read_entry
from home_mjx.errors import DatasetError
from home_mjx.schema.house import Joint, Light
from home_procgen.model_codec import POSITION_DECIMALS, decode_mesh, from_grid
from home_procgen.primitives.detail import DETAILS
from home_procgen.primitives.family import FurnitureModel, Meshes
from home_procgen.textures.finishes import default_materials

STORE = Path(__file__).parent / "data" / "models.zip"
PARTS = "parts"  # name of the array of the boxes of all models, in the order of the models
REBUILD_HINT = "Install home_mjx again; in a checkout, run `python -m home_procgen.build_library`."


class ModelStore:
    """Models of a file, decoded on first use.

    Args:
        path: A file that `home_procgen.build_library` wrote.

    Raises:
        DatasetError: The file is missing or damaged.
    """

    def __init__(self, path: Path = STORE) -> None:
        try:
            self._arrays, self._notes = read_entry(path)
            self._parts = from_grid(self._arrays[PARTS], POSITION_DECIMALS)
            self.tables: Mapping[str, Mapping[str, str]] = self._notes["tables"]
            self.numbers: Mapping[str, range] = {k: range(1, n + 1) for k, n in self._notes["families"].items()}
            self._models: Mapping[str, Mapping[str, Any]] = self._notes["models"]
        except FileNotFoundError:
            raise DatasetError("library of furniture is missing", file=path, hint=REBUILD_HINT) from None
        except READ_ERRORS as error:
            message = f"library of furniture is damaged: {error}"
            raise DatasetError(message, file=path, hint=REBUILD_HINT) from None
        self.path = path

    @property
    def ids(self) -> Sequence[str]:
        """Ids of the models, in the order of the metadata rows."""
        return list(self._models)

    def has(self, model_id: str) -> bool:
        """Return whether there is a model with an id."""
        return model_id in self._models

    def model(self, model_id: str, detail: str = DETAILS[0]) -> FurnitureModel:
        """Return a model.

        Raises:
            DatasetError: There is no such model.
        """
        if model_id not in self._models:
            raise DatasetError(f"library of furniture has no model `{model_id}`", file=self.path, hint=REBUILD_HINT)
        notes, arrays = self._models[model_id], self._arrays
        family, _, number = model_id.removeprefix("home_").rpartition("_")
        finishes, materials = notes["slots"].values(), default_materials(notes["slots"], int(number))

        def load_meshes() -> Meshes:
            stems = [model_id, f"{model_id}_0"][: 1 + notes["closed"]]
            folder = Path("object") / model_id
            return Meshes(
                *(decode_mesh(arrays[f"{detail}/{s}"], folder / f"{s}.obj", finishes, materials) for s in stems)
            )

        first, count = notes["parts"]
        return FurnitureModel(
            model_id,
            family,
            notes["fine"],
            notes["slots"],
            self._parts[first : first + count],
            load_meshes,
            tuple(Light("point", power, (1.0, 1.0, 1.0), (x, y, z)) for x, y, z, power in notes["lights"]),
            tuple(read_joint(model_id, row) for row in notes["joints"][detail]),
        )


def joint_row(joint: Joint) -> list[Any]:
    """Return a joint as a JSON value."""
    return [joint.part, joint.kind, joint.axis, joint.point, joint.low, joint.high, joint.face_ranges]


def read_joint(model_id: str, row: list[Any]) -> Joint:
    """Return the joint of a row that `joint_row` made."""
    part, kind, axis, point, low, high, ranges = row
    return Joint(model_id, part, kind, tuple(axis), tuple(point), low, high, tuple(map(tuple, ranges)))


@cache
def model_store() -> ModelStore:
    """Return the shipped models, read on first use.

    Raises:
        DatasetError: The file is missing or damaged.
    """
    return ModelStore()


def family_numbers(family: str) -> range:
    """Return the numbers of the models of a family.

    Raises:
        DatasetError: There is no such family.

    Example:
        >>> family_numbers("drumset")
        range(1, 2)
    """
    store = model_store()
    if family not in store.numbers:
        raise DatasetError(f"library of furniture has no family `{family}`", file=store.path, hint=REBUILD_HINT)
    return store.numbers[family]


@cache
def library_model(model_id: str, detail: str = DETAILS[0]) -> FurnitureModel:
    """Return the library model with an id.

    Args:
        model_id: Id of the model.
        detail: Level of detail of its meshes; boxes of its parts are those of full detail.

    Example:
        >>> library_model("home_sofa_2").fine
        'sofa'
    """
    return model_store().model(model_id, detail)


def get_model(family: str, number: int) -> FurnitureModel:
    """Return one library model at full detail.

    Args:
        family: Name of the family.
        number: Number of the model, from 1.

    Example:
        >>> get_model("sofa", 2) is library_model("home_sofa_2")
        True
    """
    return library_model(f"home_{family}_{number}")


@cache
def library(detail: str = DETAILS[0]) -> Mapping[str, FurnitureModel]:
    """Return every model by id, in the order of the metadata rows."""
    return MappingProxyType({key: library_model(key, detail) for key in model_store().ids})


def model_at_detail(model: FurnitureModel, detail: str) -> FurnitureModel:
    """Return a model with the meshes of a level of detail; models of the building have only one."""
    has_details = detail != DETAILS[0] and model.id.startswith("home_")
    return library_model(model.id, detail) if has_details else model
