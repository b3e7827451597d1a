"""What reading one house needs, and what it gathers."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, ParamSpec, TypeVar

from home_mjx.errors import DatasetError, check_flag
from home_mjx.scene_compile.house import Mesh, Problem

from .arch_json import Architecture, read_architecture
from .assets import Assets
from .files import is_file
from .place import Place, Value, printable

P = ParamSpec("P")
T = TypeVar("T")


@dataclass(frozen=True)
class ReadOptions:
    """What of a house is read.

    Args:
        people: Keep models of the coarse category `person`: dense meshes that stand still.
        plants: Keep models of the coarse category `plant`: foliage of many thousand triangles.
        backdrops: Keep boxes of 20 m and more whole. By default what they show outside of the house is cut off.

    Example:
        >>> ReadOptions(people=False).categories_left_out
        ('person',)
    """

    people: bool = True
    plants: bool = True
    backdrops: bool = False

    def __post_init__(self) -> None:
        for name in ("people", "plants", "backdrops"):
            check_flag(name, getattr(self, name))

    @property
    def categories_left_out(self) -> tuple[str, ...]:
        """Coarse categories of which no object is read."""
        return ("person",) * (not self.people) + ("plant",) * (not self.plants)


@dataclass
class Reading:
    """The state of reading one house."""

    house_id: str
    assets: Assets
    left_out: Callable[[str], bool] = lambda model_id: False  # models that the options leave out
    options: ReadOptions = ReadOptions()
    materials: Value | None = None  # the house's own list, for nodes that have `materialIndices`
    scale: float = 1.0  # [m] per unit of the file
    models: dict[str, Mesh] = field(default_factory=dict)
    others: dict[str, Mesh] = field(default_factory=dict)
    notes: list[tuple[Place, Problem]] = field(default_factory=list)
    errors: list[DatasetError] | None = None  # if a list, a broken node is put there and left out
    kept: dict[str, Any] = field(default_factory=dict)  # see `once`

    def note(self, place: Place, rule: str, message: str) -> None:
        """Keeps an oddity that was tolerated, under the name of the rule that it breaks."""
        self.notes.append((place, Problem(printable(place.element), printable(message), rule)))

    def attempt(self, read: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T | None:
        """What `read` returns; None if it raises a `DatasetError` and errors are gathered."""
        try:
            return read(*args, **kwargs)
        except DatasetError as error:
            if self.errors is None:
                raise
            self.errors.append(error)
            return None

    def once(self, key: str, read: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T:
        """What `read` returned or raised at the first call with this key: thousands of nodes may ask for one file."""
        if key not in self.kept:
            try:
                self.kept[key] = read(*args, **kwargs)
            except DatasetError as error:
                self.kept[key] = error
        if isinstance(self.kept[key], DatasetError):
            raise self.kept[key].with_traceback(None)
        return self.kept[key]

    def model(self, model_id: str, key: str, place: Place) -> Mesh:
        """A library model; arguments and errors as of `Assets.model`."""
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
