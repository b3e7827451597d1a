"""Registry of environment ids and their specs; `env_factory.make` makes environments of them."""

import dataclasses
import importlib.util
import re
import sys
from collections.abc import Callable, Mapping
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import TYPE_CHECKING, Any, TypeGuard

from home_mjx.core.checks import check_flag, check_frozen_dataclass, check_number, check_type
from home_mjx.core.jsonable import from_json, to_json
from home_mjx.errors import ConfigError, UnknownNameError, did_you_mean

if TYPE_CHECKING:
    from home_mjx.houses.selection import HouseFilter

_ID = re.compile(r"^[A-Z][A-Za-z0-9]*-v\d+$")
DEFAULT_NUM_HOUSES = 8


@dataclasses.dataclass(frozen=True)
class EnvSpec:
    """Specification of an environment; convertible to and from JSON, so that a run can be repeated.

    Attributes:
        id: `Name-vN`; N is raised whenever learning results could change.
        entry_point: `module:name` of a `Task` subclass, or of a function `(get_bank, **options)` that returns an
            environment, where `get_bank(compile_options)` makes the houses.
        options: Options by name, as for `make`. `variation` has ranges of domain randomisation by name. `episodes` is a
            file of episodes, which selects the houses from `houses`.
        houses: Folder of a dataset; None: generated houses, or `SUNCG_DATA_DIR`.
        num_houses: Number of houses.
        split: `train`, `val` or `test`; None: any.
        filter: A filter of houses; None: any.
        in_memory: True if made with a bank or dataset in memory, which JSON cannot represent.

    Raises:
        ConfigError: A value has the wrong type.

    Example:
        >>> spec = EnvSpec("PointNav-v0", "home_mjx.tasks.suite:PointNav", {"width": 32})
        >>> EnvSpec.from_json(spec.to_json()) == spec
        True
    """

    id: str
    entry_point: str
    options: Mapping[str, Any] = dataclasses.field(default_factory=dict)
    houses: str | None = None
    num_houses: int = DEFAULT_NUM_HOUSES
    split: str | None = None
    filter: "HouseFilter | None" = None
    in_memory: bool = False

    def __post_init__(self) -> None:
        check_type("id", self.id, str)
        check_type("entry_point", self.entry_point, str)
        check_type("options", self.options, Mapping)
        check_number("num_houses", self.num_houses, 1, integer=True)
        check_flag("in_memory", self.in_memory)
        for name in ("houses", "split"):
            if getattr(self, name) is not None:
                check_type(name, getattr(self, name), str)
        if self.filter is not None:
            from home_mjx.houses.selection import HouseFilter

            check_type("filter", self.filter, HouseFilter)

    def to_json(self) -> str:
        """Return the spec as JSON.

        Raises:
            ConfigError: An option, or the houses, exist in memory only.
        """
        if self.in_memory:
            hint = "Pass the folder of a dataset to `make`."
            raise ConfigError(f"{self.id} was made with houses in memory, which JSON cannot represent", hint=hint)
        return to_json(self)

    @classmethod
    def from_json(cls, text: str) -> "EnvSpec":
        """Parse the JSON of `to_json`.

        Raises:
            ConfigError: The text is not such a spec, or its environment is not registered here.
        """
        spec = from_json(text)
        if not isinstance(spec, cls):
            raise ConfigError(f"expected the JSON of an EnvSpec, got {type(spec).__name__}")
        return spec

    def check_trusted(self) -> None:
        """Raise `ConfigError` unless the entry point is that registered under the id: a file must not choose code."""
        known = _REGISTRY.get(self.id)
        if known is None or known.entry_point != self.entry_point:
            hint = "If you trust it, import the module that registers it first; on the command line, `--import MODULE`."
            raise ConfigError(f"no environment `{self.id}` of `{self.entry_point}` is registered", hint=hint)


_REGISTRY: dict[str, EnvSpec] = {}


def register(env_id: str, entry_point: str | Callable[..., Any], options: Mapping[str, Any] | None = None) -> None:
    """Add an environment to `make` and, as `home_mjx/<id>`, to Gymnasium.

    The same registration may be repeated, for example when a notebook cell runs twice.

    Args:
        env_id: `Name-vN`; raise N whenever learning results could change.
        entry_point: A `Task` subclass, a function as in `EnvSpec`, or the name `module:name` of either.
        options: Defaults of this environment's options, by name.

    Raises:
        ConfigError: The id has another form or is taken, or a `Task` subclass is not a frozen dataclass.

    Example:
        >>> register("NearGoal-v0", "home_mjx.tasks.suite:PointNav", {"success_distance": 1.0})  # doctest: +SKIP
    """
    if not _ID.match(env_id):
        raise ConfigError(f"environment id `{env_id}` is not of the form Name-vN", hint="For example PointNav-v0")
    named = entry_point if isinstance(entry_point, str) else f"{entry_point.__module__}:{entry_point.__qualname__}"
    spec = EnvSpec(env_id, named, dict(options or {}))
    if _REGISTRY.get(env_id, spec) != spec:
        raise ConfigError(f"environment id `{env_id}` is taken", hint="Raise its version number")
    if not isinstance(entry_point, str):
        if isinstance(entry_point, type):
            is_task(entry_point)
        _LOCAL_ENTRY_POINTS[named] = entry_point
    _REGISTRY[env_id] = spec
    if "gymnasium" in sys.modules:
        _add_to_gymnasium(sys.modules["gymnasium"], env_id)


def _add_to_gymnasium(gymnasium: ModuleType, env_id: str) -> None:
    """Register an id with the imported module `gymnasium`, unless it is, as single and vector environment."""
    name = f"home_mjx/{env_id}"
    if name not in gymnasium.registry:
        gymnasium.register(
            id=name,
            entry_point="home_mjx.adapters.gymnasium:GymEnv",
            vector_entry_point="home_mjx.adapters.gymnasium:GymVectorEnv",
            kwargs={"env_id": env_id},
        )


class _GymnasiumFinder:
    """Import hook that registers all ids as soon as Gymnasium is imported, so that we need not import it."""

    def find_spec(self, name: str, path: Any = None, target: Any = None) -> ModuleSpec | None:
        """Return Gymnasium's own spec, with a loader that registers the ids at its end; None for other modules.

        The hook stays installed until Gymnasium is loaded: a program may only ask whether the package is there.
        """
        if name != "gymnasium":
            return None
        sys.meta_path.remove(self)
        try:
            spec = importlib.util.find_spec(name)
        finally:
            sys.meta_path.insert(0, self)
        if spec is not None and spec.loader is not None:
            load = spec.loader.exec_module

            def load_and_register(module: ModuleType) -> None:
                """Load the module, remove the hook, and register all ids."""
                load(module)
                if self in sys.meta_path:
                    sys.meta_path.remove(self)
                for env_id in _REGISTRY:
                    _add_to_gymnasium(module, env_id)

            spec.loader.exec_module = load_and_register
        return spec


# Entry points that cannot be imported, such as those of a notebook.
_LOCAL_ENTRY_POINTS: dict[str, Callable[..., Any]] = {}


def list_envs() -> tuple[str, ...]:
    """Return all registered environment ids, sorted.

    Example:
        >>> "PointNav-v0" in list_envs()
        True
    """
    return tuple(sorted(_REGISTRY))


def task_names() -> frozenset[str]:
    """Return the names of all registered entry points without their modules, such as `PointNav`."""
    return frozenset(spec.entry_point.rpartition(":")[2].rpartition(".")[2] for spec in _REGISTRY.values())


def find_spec(env_id: str) -> EnvSpec:
    """Return the spec that is registered under an id; `UnknownNameError` names the closest known id."""
    if env_id not in _REGISTRY:
        raise UnknownNameError(f"unknown environment `{env_id}`", hint=did_you_mean(env_id, _REGISTRY))
    return _REGISTRY[env_id]


def is_task(entry_point: Callable[..., Any]) -> TypeGuard[type]:
    """Return whether the entry point is a `Task` subclass; raise `ConfigError` if that is no frozen dataclass."""
    from home_mjx.tasks.base.task import Task

    if not (isinstance(entry_point, type) and issubclass(entry_point, Task)):
        return False
    check_frozen_dataclass("task", entry_point)
    return True


def load_entry_point(entry_point: str) -> Callable[..., Any]:
    """Import the entry point `module:name`, or return a local one; raise `ConfigError` if that fails."""
    if entry_point in _LOCAL_ENTRY_POINTS:
        return _LOCAL_ENTRY_POINTS[entry_point]
    module, _, name = entry_point.partition(":")
    try:
        found: Any = importlib.import_module(module)
        for part in name.split("."):
            found = getattr(found, part)
    except ConfigError:  # raised by the imported module itself; it is a ValueError as well
        raise
    except (ImportError, AttributeError, ValueError) as error:
        raise ConfigError(f"entry point `{entry_point}` cannot be imported: {error}") from error
    return found


if "gymnasium" not in sys.modules:
    sys.meta_path.insert(0, _GymnasiumFinder())
register("PointNav-v0", "home_mjx.tasks.suite:PointNav")
for _name in ("RoomNav", "ObjectNav", "AudioNav"):
    register(f"{_name}-v0", f"home_mjx.tasks.suite:{_name}", {"actions": "discrete", "stop": True})
# In homes of three storeys the way from one object to the next takes experts up to 600 steps.
register(
    "InstructionFollowing-v0",
    "home_mjx.tasks.suite:InstructionFollowing",
    {"actions": "discrete", "stop": True, "episode_length": 1000},
)
# In half of the homes of two and three storeys an expert needs up to 1,800 steps, in nine tenths up to 3,000.
register("Exploration-v0", "home_mjx.tasks.suite:Exploration", {"actions": "discrete", "episode_length": 4000})
# In a home of three storeys an expert may need 400 steps to reach the piper, and then follows it for 80.
register(
    "PiedPiper-v0", "home_mjx.tasks.suite:PiedPiper", {"actions": "discrete", "num_agents": 3, "episode_length": 1000}
)
register("HouseQA-v0", "home_mjx.tasks.suite:HouseQA", {"actions": "discrete"})
register("VQA-v0", "home_mjx.tasks.suite:VQA", {"actions": "discrete"})
register("Dialogue-v0", "home_mjx.tasks.suite:Dialogue", {"actions": "discrete", "stop": True})
register(
    "Communication-v0", "home_mjx.tasks.suite:Communication", {"actions": "discrete", "stop": True, "num_agents": 2}
)
# Pitch steps of 15 degrees, down to 60 as in AI2-THOR. The way there and back in a home of three storeys takes experts
# up to 700 steps.
_HANDS = {"hands": True, "max_aim_angle": 10.0, "max_pitch": 1.05, "episode_length": 1000}
for _name in ("Fetch", "Rearrange"):
    register(f"{_name}-v0", f"home_mjx.tasks.suite:{_name}", {"actions": "discrete", "stop": True, **_HANDS})
register(
    "Toggle-v0",
    "home_mjx.tasks.suite:Toggle",
    {"actions": "discrete", "stop": True, "switches": "random", **_HANDS},
)
register(
    "FetchFromContainer-v0",
    "home_mjx.tasks.suite:FetchFromContainer",
    {"actions": "discrete", "stop": True, "max_fronts": 24, **_HANDS},
)
