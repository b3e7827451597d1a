"""Registry of environment ids, and the construction of environments."""

import dataclasses
import importlib
import re
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeGuard

import gymnasium

from home_mjx.core.checks import check_flag, check_number, check_type
from home_mjx.core.files import as_path
from home_mjx.core.jsonable import from_json, to_json
from home_mjx.errors import ConfigError, DatasetError, UnknownNameError, did_you_mean

if TYPE_CHECKING:
    from home_mjx.bank.bank import HouseBank
    from home_mjx.datasets.suncg.dataset import Dataset
    from home_mjx.scene_compile.cache.house_set import HouseSet
    from home_mjx.scene_compile.cache.selection import HouseFilter
    from home_mjx.scene_compile.pipeline.compile import CompileOptions
    from home_mjx.schema.compiled import CompiledHouse
    from home_mjx.tasks.environment.bound import BoundEnv
    from home_mjx.tasks.environment.household import HouseholdEnv
    from home_mjx.tasks.environment.memory import MemoryEstimate

_ID = re.compile(r"^[A-Z][A-Za-z0-9]*-v\d+$")
NUM_HOUSES = 8
NUM_ARRANGEMENTS = 8  # arrangements per house if `arrangement` is "random"
OF_MAKE = ("houses", "num_houses", "split", "where", "progress", "variation", "episodes")
OF_EPISODES = ("variation", "episodes")  # options that change parameters of the environment, not its program


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
        where: A filter of houses; None: any.
        in_memory: True if made with a bank or dataset in memory, which JSON cannot represent.

    Raises:
        ConfigError: A value has the wrong type.

    Example:
        >>> spec = EnvSpec("PointNav-v0", "home_mjx.tasks:PointNav", {"width": 32})
        >>> EnvSpec.from_json(spec.to_json()) == spec
        True
    """

    id: str
    entry_point: str
    options: Mapping[str, Any] = dataclasses.field(default_factory=dict)
    houses: str | None = None
    num_houses: int = NUM_HOUSES
    split: str | None = None
    where: "HouseFilter | None" = None
    in_memory: bool = False

    def __post_init__(self) -> None:
        check_type("id", self.id, str)
        check_type("entry_point", self.entry_point, str)
        check_type("options", self.options, Mapping)
        check_number("num_houses", self.num_houses, 1, whole=True)
        check_flag("in_memory", self.in_memory)
        for name in ("houses", "split"):
            if getattr(self, name) is not None:
                check_type(name, getattr(self, name), str)
        if self.where is not None:
            from home_mjx.scene_compile.cache.selection import HouseFilter

            check_type("where", self.where, HouseFilter)

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
        """Check that the entry point is the one registered under the id, so that a file cannot run other code.

        Raises:
            ConfigError: It is not registered, or another one is.
        """
        known = _REGISTRY.get(self.id)
        if known is None or known.entry_point != self.entry_point:
            hint = "If you trust it, import the module that registers it first; on the command line, `--import MODULE`."
            raise ConfigError(f"no environment `{self.id}` of `{self.entry_point}` is registered", hint=hint)

    def memory_estimate(self, num_envs: int, progress: bool | None = None) -> "MemoryEstimate":
        """Estimate the device memory of `num_envs` environments; houses are packed on the host for it."""
        import jax

        from home_mjx.tasks.environment.memory import estimate_memory

        with jax.default_device(jax.devices("cpu")[0]):
            return estimate_memory(self.make(progress), num_envs)

    def core(self) -> "HouseholdEnv | None":
        """Return the environment's functions, which need no houses; None if the entry point is a function.

        Raises:
            ConfigError: An option is unknown or invalid.
        """
        entry_point = _load(self.entry_point)
        options = {name: value for name, value in self.options.items() if name not in OF_EPISODES}
        return _core_of(entry_point, options)[0] if _is_task(entry_point) else None

    def make(self, progress: bool | None = None) -> "BoundEnv[HouseholdEnv]":
        """Make the environment."""
        return _made(self, self.houses, progress)


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
        >>> register("NearGoal-v0", "home_mjx.tasks:PointNav", {"success_radius": 1.0})  # doctest: +SKIP
    """
    if not _ID.match(env_id):
        raise ConfigError(f"environment id `{env_id}` is not of the form Name-vN", hint="For example PointNav-v0")
    named = entry_point if isinstance(entry_point, str) else f"{entry_point.__module__}:{entry_point.__qualname__}"
    spec = EnvSpec(env_id, named, dict(options or {}))
    if _REGISTRY.get(env_id, spec) != spec:
        raise ConfigError(f"environment id `{env_id}` is taken", hint="Raise its version number")
    if not isinstance(entry_point, str):
        if isinstance(entry_point, type):
            _is_task(entry_point)
        _LOCAL[named] = entry_point
    _REGISTRY[env_id] = spec
    name = f"home_mjx/{env_id}"
    if name not in gymnasium.registry:
        gymnasium.register(
            id=name,
            entry_point="home_mjx.adapters.gymnasium:GymEnv",
            vector_entry_point="home_mjx.adapters.gymnasium:GymVectorEnv",
            kwargs={"env_id": env_id},
        )


_LOCAL: dict[str, Callable[..., Any]] = {}  # entry points that cannot be imported, such as those of a notebook


def list_envs() -> tuple[str, ...]:
    """Return all environment ids.

    Example:
        >>> "PointNav-v0" in list_envs()
        True
    """
    return tuple(sorted(_REGISTRY))


def find_spec(env_id: str) -> EnvSpec:
    """Return the spec that is registered under an id.

    Raises:
        ConfigError: The id is unknown; the error names the closest known one.
    """
    if env_id not in _REGISTRY:
        raise UnknownNameError(f"unknown environment `{env_id}`", hint=did_you_mean(env_id, _REGISTRY))
    return _REGISTRY[env_id]


def make(
    env_id: str,
    houses: "HouseBank | HouseSet | Dataset | str | Path | None" = None,
    *,
    num_houses: int | None = None,
    split: str | None = None,
    where: "HouseFilter | None" = None,
    progress: bool | None = None,
    variation: Any = None,
    episodes: str | Path | None = None,
    **options: Any,
) -> "BoundEnv[HouseholdEnv]":
    """Make an environment by id.

    Args:
        env_id: Id such as `PointNav-v0`, see `list_envs`.
        houses: A `HouseBank`, a `HouseSet`, a dataset or its root folder, or None. None uses the dataset in the
            environment variable `SUNCG_DATA_DIR`, or else generated houses, which are made once and cached.
            `procedural:16?seed=0&version=2` selects generated houses.
        num_houses: Maximum number of houses of a dataset or generator; default: 8, or the number in a `procedural:`
            name.
        split: Only houses of `train`, `val` or `test`.
        where: A `HouseFilter`: only houses of a dataset that fulfil all its conditions.
        progress: Show a progress bar while houses are made and compiled; None: in a terminal.
        variation: Domain randomisation per episode: a `tasks.Variation`, or its ranges by name such as
            `{"lamps": 0.5, "colors": (0, 0.3)}`; None: nothing varies.
        episodes: A file of `save_episodes` or `save_tasks`. Resets use its rows in order, in the houses that they name,
            unless `houses` is a bank. None: episodes are sampled.
        **options: Fields of `EnvConfig` and of its nested records, of the task (`task.*`) and of `CompileOptions`
            (`compile.*`): flat (`width=32`, `friction=0.5`, `success_radius=0.2`), dotted (`**{"physics.friction":
            0.5}`) or as whole records (`physics=PhysicsConfig(...)`).

    Returns:
        An environment with `reset(key)` and `step(state, action)`; `.core` has the functions that take `.params`.

    Raises:
        ConfigError: An id or option is unknown; the error names the closest known one.
        DatasetError: The dataset cannot be read.

    Example:
        >>> env = make("PointNav-v0", num_houses=4, sensors=("depth", "goal"))  # doctest: +SKIP
    """
    known = find_spec(env_id)
    in_memory = houses is not None and not isinstance(houses, str | Path)
    if in_memory and _is_chosen(houses):
        for name, value in (("num_houses", num_houses), ("split", split), ("where", where)):
            if value is not None:
                raise ConfigError(f"`{name}` selects houses of a dataset, not of {type(houses).__name__}")
    if episodes is not None:
        for name, value in (("num_houses", num_houses), ("split", split), ("where", where)):
            if value is not None:
                hint = f"Omit `{name}`: the file of episodes selects the houses."
                raise ConfigError(f"`{name}` cannot be combined with a file of episodes", hint=hint)
        options["episodes"] = str(as_path(episodes, "episodes"))
    spec = dataclasses.replace(
        known,
        options={**known.options, **options, **_ranges(variation)},
        houses=str(houses) if isinstance(houses, str | Path) else None,
        num_houses=_num_houses(houses, num_houses),
        split=split,
        where=where,
        in_memory=in_memory,
    )
    return _made(spec, houses, progress)


def _num_houses(houses: Any, given: int | None) -> int:
    """Return the number of houses: the argument, at most that of a `procedural:` name, or the default."""
    from home_mjx.datasets.generators.names import ProceduralHouses

    named = ProceduralHouses.named(houses)
    if given is None:
        return named.count if named else NUM_HOUSES
    check_number("num_houses", given, 1, whole=True)
    if named and given > named.count:
        message = f"`num_houses` is {given}, but `{houses}` names {named.count} houses"
        raise ConfigError(message, hint=f"Omit it, or use `procedural:{given}`.")
    return given


def _made(spec: EnvSpec, houses: Any, progress: bool | None) -> "BoundEnv[HouseholdEnv]":
    entry_point, options = _load(spec.entry_point), dict(spec.options)
    variation = _ranges(options.pop("variation", None))
    shown = sys.stderr.isatty() if progress is None else progress
    file = _episode_file(options.pop("episodes", None))
    split, where = (spec.split, spec.where) if file is None else (None, None)

    def get_bank(
        compile_options: "CompileOptions | None" = None, num_arrangements: int = 0, late_sound: bool = False
    ) -> "HouseBank":
        chosen = houses if file is None else _houses_of(file, houses, shown)
        bank = as_bank(chosen, spec.num_houses, shown, split, where, compile_options, late_sound)
        return _arranged(bank, num_arrangements, shown) if num_arrangements and bank is not houses else bank

    if _is_task(entry_point):
        env = _with_task(entry_point, get_bank, options, file)
    else:
        env = entry_point(get_bank, **options)
        env = env if file is None else env.with_tasks(_rows(file, env.bank, env.task))
    env = env.with_variation(variation["variation"]) if variation else env
    env.spec = spec
    return env


def _episode_file(path: Any) -> Path | None:
    return None if path is None else as_path(path, "episodes")


def _houses_of(file: Path, houses: Any, progress: bool) -> "HouseBank | HouseSet":
    """Return the houses that a file of episodes names."""
    from home_mjx.core.paths import dataset_root
    from home_mjx.datasets.procedural.default_houses import houses_by_id
    from home_mjx.scene_compile.cache.house_set import HouseSet
    from home_mjx.tasks.environment.episodes import houses_named

    if _is_chosen(houses):
        return houses
    ids = houses_named(file)
    if houses is None and dataset_root() is None:
        return HouseSet(houses_by_id(ids, progress), ids)
    return HouseSet(houses, ids)


def _rows(file: Path, bank: "HouseBank", task: Any) -> Any:
    from home_mjx.tasks.environment.episodes import load_rows
    from home_mjx.tasks.rows.task_bank import TaskBank

    rows = load_rows(file, bank, task)
    if isinstance(rows, TaskBank):
        _check_names(file, rows.names, [generator.name for generator in task.generators])
    return rows


def _check_names(file: Path, found: tuple[str, ...], own: list[str]) -> None:
    """Reject a file that has only other registered tasks; unregistered names are allowed."""
    known = {spec.entry_point.rpartition(":")[2].rpartition(".")[2] for spec in _REGISTRY.values()}
    others = [name for name in found if name in known]
    if others and not set(found) & set(own):
        message = f"file contains tasks of {', '.join(others)}, but not of {', '.join(own)}"
        raise DatasetError(message, file=file, element="task", hint=f"Make the environment of {others[0]}.")


def _ranges(variation: Any) -> dict[str, Any]:
    """Return the option as numbers by name, validated before any house is compiled; empty if nothing varies."""
    if variation is None:
        return {}
    from home_mjx.tasks.variation.ranges import named

    return {"variation": named(variation)}


def _is_task(entry_point: Callable[..., Any]) -> TypeGuard[type]:
    """Return whether the entry point is a `Task` subclass; an invalid one raises."""
    from home_mjx.tasks.base.task import Task, check_task_class

    if not (isinstance(entry_point, type) and issubclass(entry_point, Task)):
        return False
    check_task_class(entry_point)
    return True


def _with_task(
    task: type, get_bank: Callable[..., "HouseBank"], options: Mapping[str, Any], file: Path | None
) -> "BoundEnv[HouseholdEnv]":
    from home_mjx.tasks.base.state import EnvParams

    core, compiling = _core_of(task, options)  # rejects invalid options before any house is compiled
    num_arrangements = NUM_ARRANGEMENTS if core.own_config.arrangement == "random" else 0
    bank = get_bank(compiling, num_arrangements, core.config.audio.late == "baked")
    return core.bind(bank if file is None else EnvParams(bank, _rows(file, bank, core.task)))


def _core_of(task: type, options: Mapping[str, Any]) -> "tuple[HouseholdEnv, CompileOptions]":
    """Return the functions of an environment, and the compile options of its houses."""
    from home_mjx.scene_compile.pipeline.compile import CompileOptions
    from home_mjx.tasks.base.config import EnvConfig
    from home_mjx.tasks.base.options import override
    from home_mjx.tasks.environment.household import HouseholdEnv

    records = {"": EnvConfig(), "task": task(), "compile": CompileOptions()}
    chosen = override(records, options, OF_MAKE)
    core = HouseholdEnv(chosen[""], chosen["task"])
    body, compiling = chosen[""].body, chosen["compile"]
    walkable = dataclasses.replace(compiling.navigation, agent_radius=body.radius, agent_height=body.height)
    return core, dataclasses.replace(compiling, navigation=walkable)


def _arranged(bank: "HouseBank", num_arrangements: int, progress: bool) -> "HouseBank":
    import jax

    from home_mjx.arrangements import settled_poses

    return settled_poses(bank, num_arrangements, jax.random.key(0), progress)[0]


def _load(entry_point: str) -> Callable[..., Any]:
    if entry_point in _LOCAL:
        return _LOCAL[entry_point]
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


def _is_chosen(houses: Any) -> bool:
    from home_mjx.bank.bank import HouseBank
    from home_mjx.scene_compile.cache.house_set import HouseSet

    return isinstance(houses, HouseBank | HouseSet)


def as_bank(
    houses: Any,
    num_houses: int = NUM_HOUSES,
    progress: bool = False,
    split: str | None = None,
    where: "HouseFilter | None" = None,
    compile_options: "CompileOptions | None" = None,
    late_sound: bool = False,
) -> "HouseBank":
    """Convert the `houses` argument of `make` to a bank; `late_sound` bakes late reverberation if houses are loaded.

    Raises:
        ConfigError: `houses` has another type, or a filter was passed for generated houses.
    """
    from home_mjx.bank.bank import HouseBank
    from home_mjx.scene_compile.cache.house_set import HouseSet, default_houses
    from home_mjx.scene_compile.pipeline.compile import DEFAULT_OPTIONS

    if isinstance(houses, HouseBank):
        return houses
    options = compile_options or DEFAULT_OPTIONS
    check_number("num_houses", num_houses, 1, whole=True)
    if houses is None:
        chosen = default_houses(num_houses, split=split, where=where, options=options, progress=progress)
    elif isinstance(houses, HouseSet):
        chosen = HouseSet.of(houses, split=split, where=where)
        chosen = dataclasses.replace(chosen, options=options) if chosen.options == DEFAULT_OPTIONS else chosen
    else:
        chosen = HouseSet(houses, split=split, where=where, num_houses=num_houses, options=options)
    if late_sound:
        return _with_sound(chosen.load(progress))
    return HouseBank.from_dataset(chosen, progress=progress)


def _with_sound(houses: "list[CompiledHouse]") -> "HouseBank":
    from home_mjx.audio_jax import with_late_sound
    from home_mjx.bank.bank import HouseBank

    # Baking takes minutes the first time, so its progress bar is always shown.
    return with_late_sound(HouseBank.from_compiled(houses), houses, progress=True)


register("PointNav-v0", "home_mjx.tasks:PointNav")
for _name in ("RoomNav", "ObjectNav", "InstructionFollowing", "AudioNav"):
    register(f"{_name}-v0", f"home_mjx.tasks:{_name}", {"actions": "discrete", "stop": True})
# Number of exploration steps of Chaplot et al. with the same actions (arXiv:2004.05155).
register("Exploration-v0", "home_mjx.tasks:Exploration", {"actions": "discrete", "episode_length": 1000})
register("PiedPiper-v0", "home_mjx.tasks:PiedPiper", {"actions": "discrete", "num_agents": 3})
register("HouseQA-v0", "home_mjx.tasks:HouseQA", {"actions": "discrete"})
register("VQA-v0", "home_mjx.tasks:VQA", {"actions": "discrete"})
register("Dialogue-v0", "home_mjx.tasks:Dialogue", {"actions": "discrete", "stop": True})
register("Communication-v0", "home_mjx.tasks:Communication", {"actions": "discrete", "stop": True, "num_agents": 2})
_HANDS = {"hands": True, "aim_angle": 10.0, "pitch_max": 1.05}  # pitch steps of 15 degrees, down to 60 as in AI2-THOR
for _name in ("Fetch", "Rearrange"):
    register(f"{_name}-v0", f"home_mjx.tasks:{_name}", {"actions": "discrete", "stop": True, **_HANDS})
