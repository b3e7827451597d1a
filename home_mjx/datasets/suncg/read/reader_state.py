"""State of the reader for one house."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, ParamSpec, TypeVar

from home_mjx.core.files import is_file
from home_mjx.datasets.base import ReadOptions
from home_mjx.datasets.suncg.formats.asset_library import AssetLibrary
from home_mjx.datasets.suncg.formats.json_value import JsonValue, Location, printable
from home_mjx.datasets.suncg.formats.variants import SuncgMetadata
from home_mjx.datasets.suncg.read.arch_json import Architecture, read_architecture
from home_mjx.errors import DatasetError
from home_mjx.schema.house import Fallback, Mesh, Problem

P = ParamSpec("P")
T = TypeVar("T")


@dataclass
class ReaderState:
    """State of the reader for one house."""

    house_id: str
    assets: AssetLibrary
    is_excluded: Callable[[str], bool] = lambda model_id: False  # returns whether the options leave out a model
    options: ReadOptions = field(default_factory=ReadOptions)
    materials: JsonValue | None = None  # material list of the house, for nodes with `materialIndices`
    scale: float = 1.0  # [m] per unit of the file
    models: dict[str, Mesh] = field(default_factory=dict)
    other_models: dict[str, Mesh] = field(default_factory=dict)  # of the other states of objects
    notes: list[tuple[Location, Problem]] = field(default_factory=list)
    errors: list[DatasetError] | None = None  # if a list, errors are collected here and broken nodes dropped
    results: dict[str, Any] = field(default_factory=dict)  # results and errors of `cached`
    tables: SuncgMetadata = field(default_factory=lambda: SuncgMetadata({}))  # tables of the dataset
    fallbacks: list[Fallback] = field(default_factory=list)  # fallbacks for missing parts, if the assets are tolerant
    fallback_keys: set[str] = field(default_factory=set)  # keys of `models` that are fallbacks
    missing_parts: dict[tuple[str, str], str] = field(default_factory=dict)  # reason, by room path and kind of mesh

    @property
    def tolerant(self) -> bool:
        """True if missing parts get fallbacks."""
        return self.assets.tolerant

    def note(self, place: Location, rule: str, message: str) -> None:
        """Record a tolerated irregularity, with the key in `RULES` of the validator's rule that it violates."""
        self.notes.append((place, Problem(printable(place.element), printable(message), rule)))

    def attempt(self, read: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T | None:
        """Return the result of `read`; None if it raises a `DatasetError` and errors are collected."""
        try:
            return read(*args, **kwargs)
        except DatasetError as error:
            if self.errors is None:
                raise
            self.errors.append(error)
            return None

    def cached(self, key: str, read: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T:
        """Return the result, or raise the `DatasetError`, of the first call with this key; later calls do not read."""
        if key not in self.results:
            try:
                self.results[key] = read(*args, **kwargs)
            except DatasetError as error:
                self.results[key] = error
        if isinstance(self.results[key], DatasetError):
            raise self.results[key].with_traceback(None)
        return self.results[key]

    def model(self, model_id: str, key: str, place: Location) -> Mesh:
        """Return a library model; arguments and errors as in `AssetLibrary.model`."""
        self.assets.find_model(model_id, key, place)
        return self.cached(f"object/{key}", self.assets.model, model_id, key, place)

    @property
    def architecture(self) -> Architecture | None:
        """SUNCG v2's description of walls, floors and ceilings; None if the house has no such file.

        Raises:
            DatasetError: The file is broken.
        """
        return self.cached("architecture", self._read_architecture)

    def _read_architecture(self) -> Architecture | None:
        """Read the architecture file; None if it does not exist."""
        path = self.assets.root / "wall" / self.house_id / f"{self.house_id}.arch.json"
        return read_architecture(path, self.assets.textures, self.note) if is_file(path) else None
