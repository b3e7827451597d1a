"""The state of reading one house."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, ParamSpec, TypeVar

from home_mjx.core.files import is_file
from home_mjx.datasets.options import ReadOptions
from home_mjx.datasets.suncg.formats.asset_library import AssetLibrary
from home_mjx.datasets.suncg.formats.element import Place, Value, printable
from home_mjx.datasets.suncg.read.arch_json import Architecture, read_architecture
from home_mjx.errors import DatasetError
from home_mjx.schema.house import Mesh, Metadata, Problem, StandIn

P = ParamSpec("P")
T = TypeVar("T")


@dataclass
class Reading:
    """The state of reading one house."""

    house_id: str
    assets: AssetLibrary
    left_out: Callable[[str], bool] = lambda model_id: False  # models that the options leave out
    options: ReadOptions = field(default_factory=ReadOptions)
    materials: Value | None = None  # the house's own list, for nodes that have `materialIndices`
    scale: float = 1.0  # [m] per unit of the file
    models: dict[str, Mesh] = field(default_factory=dict)
    others: dict[str, Mesh] = field(default_factory=dict)
    notes: list[tuple[Place, Problem]] = field(default_factory=list)
    errors: list[DatasetError] | None = None  # if a list, a broken node is put there and left out
    kept: dict[str, Any] = field(default_factory=dict)  # see `once`
    tables: Metadata = field(default_factory=lambda: Metadata({}))  # as the dataset has them, for stand-ins
    stand_ins: list[StandIn] = field(default_factory=list)  # for what is lacking, if the assets are tolerant
    stood_in: set[str] = field(default_factory=set)  # keys of `models` that are stand-ins
    lacking_parts: dict[tuple[str, str], str] = field(default_factory=dict)  # why, by path of a room and kind of mesh

    @property
    def tolerant(self) -> bool:
        """Whether stand-ins are taken for what is lacking."""
        return self.assets.tolerant

    def note(self, place: Place, rule: str, message: str) -> None:
        """Records a tolerated oddity under the name of the rule that it breaks."""
        self.notes.append((place, Problem(printable(place.element), printable(message), rule)))

    def attempt(self, read: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T | None:
        """The result of `read`; None if it raises a `DatasetError` and errors are collected."""
        try:
            return read(*args, **kwargs)
        except DatasetError as error:
            if self.errors is None:
                raise
            self.errors.append(error)
            return None

    def once(self, key: str, read: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T:
        """The result or error of the first call with this key: thousands of nodes may need one file."""
        if key not in self.kept:
            try:
                self.kept[key] = read(*args, **kwargs)
            except DatasetError as error:
                self.kept[key] = error
        if isinstance(self.kept[key], DatasetError):
            raise self.kept[key].with_traceback(None)
        return self.kept[key]

    def model(self, model_id: str, key: str, place: Place) -> Mesh:
        """A library model; arguments and errors as of `AssetLibrary.model`."""
        self.assets.find_model(model_id, key, place)
        return self.once(f"object/{key}", self.assets.model, model_id, key, place)

    @property
    def architecture(self) -> Architecture | None:
        """SUNCG v2's description of walls, floors and ceilings; None if the dataset has none of this house.

        Raises:
            DatasetError: It is broken.
        """
        return self.once("architecture", self._read_architecture)

    def _read_architecture(self) -> Architecture | None:
        path = self.assets.root / "wall" / self.house_id / f"{self.house_id}.arch.json"
        return read_architecture(path, self.assets.textures, self.note) if is_file(path) else None
