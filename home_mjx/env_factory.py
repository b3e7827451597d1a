"""`make`: from an id, options and the name of houses to an environment, in the order of its steps."""

import dataclasses
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from home_mjx.core.checks import check_number
from home_mjx.core.files import as_path
from home_mjx.core.native.fork_guard import check_not_forked, record_process
from home_mjx.core.progress import is_progress_shown
from home_mjx.errors import ConfigError, DatasetError
from home_mjx.registry import DEFAULT_NUM_HOUSES, EnvSpec, find_spec, is_task, load_entry_point, task_names

if TYPE_CHECKING:
    from home_mjx.bank.bank import HouseBank
    from home_mjx.datasets.base import Dataset
    from home_mjx.houses.bakes import Bake
    from home_mjx.houses.house_set import HouseSet
    from home_mjx.houses.selection import HouseFilter
    from home_mjx.scene_compile.pipeline.compile import CompileOptions
    from home_mjx.tasks.env.env import Env
    from home_mjx.tasks.env.household import HouseholdEnv

EPISODE_OPTIONS = ("variation", "episodes")  # options that change parameters of the environment, not its program
NUM_ARRANGEMENTS = 8  # poses of movable objects per house for `arrangement="random"`
MAKE_ARGUMENTS = ("houses", "num_houses", "split", "filter", "progress", "variation", "episodes")


def make(
    env_id: str | EnvSpec,
    houses: "HouseBank | HouseSet | Dataset | str | Path | None" = None,
    *,
    num_houses: int | None = None,
    split: str | None = None,
    filter: "HouseFilter | None" = None,
    progress: bool | None = None,
    variation: Any = None,
    episodes: str | Path | None = None,
    **options: Any,
) -> "Env[HouseholdEnv]":
    """Make an environment by its id or spec.

    Args:
        env_id: Such as `PointNav-v0`, see `list_envs`; or an `EnvSpec`, which takes no other argument but `progress`.
        houses: A `HouseBank`, a `HouseSet`, a dataset, its folder or its name such as
            `procedural:16?seed=0`; None: the dataset that the environment variable `SUNCG_DATA_DIR` names,
            or, if it is not set, generated houses, which are written once into the cache folder. A `HouseSet` is
            loaded whole.
        num_houses: Maximum number of houses; by default all of a name such as `procedural:16`, else 8.
        split: Only houses of `train`, `val` or `test`.
        filter: Only houses of a dataset that pass this `HouseFilter`.
        progress: Say on stderr what is generated, compiled and baked, also at the first reset and step; None: by the
            rule of `home_mjx.core.progress`.
        variation: Domain randomisation per episode: a `tasks.Variation`, or its ranges by name such as
            `{"lamps": 0.5, "colors": (0, 0.3)}`; None: none.
        episodes: File written by `save_episodes` or `save_tasks`: resets take its rows in order, in the houses that it
            names unless `houses` is a bank; None: episodes are sampled.
        **options: Fields of `EnvConfig` and its records, of the task (`task.*`) and of `CompileOptions` (`compile.*`):
            flat (`width=32`, `friction_corner=0.5`, `success_distance=0.2`), dotted (`**{"physics.friction_corner":
            0.5}`) or as whole records (`physics=PhysicsConfig(...)`).

    Returns:
        An environment with `reset(key)` and `step(state, action)`; `.core` has the functions that take `.params`.

    Raises:
        ConfigError: An id or option is unknown; the message names the closest known one. Or `num_houses`, `split` or
            `filter` accompany a bank, a `HouseSet` or `episodes`, which choose the houses themselves.
        DatasetError: The dataset cannot be read.
        BackendError: This is a forked child of a process that has made an environment: JAX would wait there forever.

    Example:
        >>> env = make("PointNav-v0", num_houses=4, sensors=("depth", "goal"))  # doctest: +SKIP
    """
    chosen = {"num_houses": num_houses, "split": split, "filter": filter}
    if isinstance(env_id, EnvSpec):
        others = chosen | {"houses": houses, "variation": variation, "episodes": episodes} | options
        _refuse(others, lambda name: f"`{name}` cannot be combined with an EnvSpec", "the spec has it")
        return build_env(env_id, env_id.houses, progress)
    known = find_spec(env_id)
    in_memory = houses is not None and not isinstance(houses, str | Path)
    if in_memory and _is_chosen(houses):
        _refuse(chosen, lambda name: f"`{name}` chooses houses of a dataset, not of {type(houses).__name__}")
    if episodes is not None:
        _refuse(
            chosen, lambda name: f"`{name}` cannot be combined with a file of episodes", "the houses are those it names"
        )
        options["episodes"] = str(as_path(episodes, "episodes"))
    spec = dataclasses.replace(
        known,
        options={**known.options, **options, **_ranges(variation)},
        houses=str(houses) if isinstance(houses, str | Path) else None,
        num_houses=_num_houses(houses, num_houses),
        split=split,
        filter=filter,
        in_memory=in_memory,
    )
    return build_env(spec, houses, progress)


def make_core(spec: EnvSpec) -> "HouseholdEnv | None":
    """Make the functions of an environment, which need no houses; None if the entry point is a function, not a `Task`.

    Raises:
        ConfigError: An option is unknown or invalid.

    Example:
        >>> make_core(find_spec("PointNav-v0")).num_agents
        1
    """
    entry_point = load_entry_point(spec.entry_point)
    options = {name: value for name, value in spec.options.items() if name not in EPISODE_OPTIONS}
    return core_of(entry_point, options)[0] if is_task(entry_point) else None


def build_env(spec: EnvSpec, houses: Any, progress: bool | None = None) -> "Env[HouseholdEnv]":
    """Build the environment of a spec in given houses; errors as of `make`.

    Args:
        spec: Id, entry point and options.
        houses: As of `make`; `spec.houses` for a spec from a file.
        progress: As of `make`.
    """
    check_not_forked("make an environment")
    record_process()
    entry_point, options = load_entry_point(spec.entry_point), dict(spec.options)
    variation, file = _ranges(options.pop("variation", None)), options.pop("episodes", None)
    file = None if file is None else as_path(file, "episodes")
    shown = is_progress_shown(progress)

    def get_bank(
        compile_options: "CompileOptions | None" = None, bakes: "tuple[Bake, ...]" = (), image_edge: int = 0
    ) -> "HouseBank":
        """Return the bank with these options and bakes, for images up to an edge [px]; one in memory is unchanged."""
        return _load(spec, houses, file, compile_options, bakes, image_edge, shown)

    if is_task(entry_point):
        env = _task_env(entry_point, get_bank, options, file, houses, shown)
    else:
        env = entry_point(get_bank, **options)
        env = env if file is None else env.with_tasks(_episode_rows(file, env.bank, env.task))
    env = env.with_variation(variation["variation"]) if variation else env
    env.spec = spec
    return env


def _load(
    spec: EnvSpec,
    houses: Any,
    file: Path | None,
    compile_options: "CompileOptions | None",
    bakes: "tuple[Bake, ...]",
    image_edge: int,
    progress: bool,
) -> "HouseBank":
    """Return the bank of the houses, or of those that a file of episodes names; a `HouseBank` is returned unchanged.

    With a file, ids come from it, and the spec's `num_houses`, `split` and `filter` have no effect. A `HouseSet` is
    loaded whole, also with a file. Errors are those of `load_bank` and `read_house_ids`.
    """
    from home_mjx.bank.bank import HouseBank
    from home_mjx.bank.packing.texture_layers import texture_size_for
    from home_mjx.houses.load import load_bank
    from home_mjx.scene_compile.pipeline.compile import DEFAULT_OPTIONS
    from home_mjx.tasks.env.episodes import read_house_ids

    if isinstance(houses, HouseBank):
        return houses
    shared = {
        "options": compile_options or DEFAULT_OPTIONS,
        "progress": progress,
        "bakes": bakes,
        "texture_size": texture_size_for(image_edge),
    }
    if file is not None and not _is_chosen(houses):
        return load_bank(houses, ids=read_house_ids(file), **shared)
    num_houses = None if _is_chosen(houses) else spec.num_houses
    split, filter = (spec.split, spec.filter) if file is None else (None, None)
    return load_bank(houses, num_houses=num_houses, split=split, filter=filter, **shared)


def _task_env(
    task: type,
    get_bank: Callable[..., "HouseBank"],
    options: Mapping[str, Any],
    file: Path | None,
    houses: Any,
    progress: bool,
) -> "Env[HouseholdEnv]":
    """Make an environment of a `Task` subclass; refuse wrong options before any house is compiled.

    With random arrangements, add `NUM_ARRANGEMENTS` to the bank, unless it is the one given as `houses`.
    """
    from home_mjx.tasks.base.state import EnvParams

    core, compile_options = core_of(task, options)
    core.progress = progress
    edge = max((max(view.lens.shape) for view in core.config.all_cameras if "rgb" in view.kinds), default=0)
    bank = get_bank(compile_options, core.bakes, edge)
    if core.acting_config.arrangement == "random" and bank is not houses:
        import jax

        from home_mjx.tasks.arrangements import with_arrangements

        bank = with_arrangements(bank, NUM_ARRANGEMENTS, jax.random.key(0), progress)[0]
    return core.bind(bank if file is None else EnvParams(bank, _episode_rows(file, bank, core.task)))


def core_of(task: type, options: Mapping[str, Any]) -> "tuple[HouseholdEnv, CompileOptions]":
    """Return an environment's functions, and compile options whose walkable area is for the size of the common `body`.

    Bodies of single agents (`physics.bodies`) have no effect on it, nor do sizes given in `compile.navigation`.

    Raises:
        ConfigError: An option is unknown or cannot be used.
    """
    from home_mjx.scene_compile.pipeline.compile import CompileOptions
    from home_mjx.tasks.base.config import EnvConfig
    from home_mjx.tasks.base.options import override_options
    from home_mjx.tasks.env.household import HouseholdEnv

    records = {"": EnvConfig(), "task": task(), "compile": CompileOptions()}
    chosen = override_options(records, options, MAKE_ARGUMENTS)
    core = HouseholdEnv(chosen[""], chosen["task"])
    body, compiling = chosen[""].body, chosen["compile"]
    walkable = dataclasses.replace(compiling.navigation, agent_radius=body.radius, agent_height=body.height)
    return core, dataclasses.replace(compiling, navigation=walkable)


def _num_houses(houses: Any, given: int | None) -> int:
    """Return `given`, else the number of houses of a name such as `procedural:16`, else `DEFAULT_NUM_HOUSES`.

    Raises:
        ConfigError: `given` is not a positive integer, or exceeds the number that the name has.
    """
    from home_mjx.datasets.registry import has_scheme, open_dataset

    known = len(open_dataset(houses).house_ids) if has_scheme(houses) else None
    if given is None:
        return known or DEFAULT_NUM_HOUSES
    check_number("num_houses", given, 1, integer=True)
    if known is not None and given > known:
        message = f"`num_houses` is {given}, but `{houses}` has {known} houses"
        raise ConfigError(message, hint="Leave it out, or name more houses.")
    return given


def _is_chosen(houses: Any) -> bool:
    """Return whether `houses` is a bank or a `HouseSet`, to which `num_houses`, `split` and `filter` cannot apply."""
    from home_mjx.bank.bank import HouseBank
    from home_mjx.houses.house_set import HouseSet

    return isinstance(houses, HouseBank | HouseSet)


def _refuse(chosen: Mapping[str, Any], message: Callable[[str], str], reason: str | None = None) -> None:
    """Raise `ConfigError` with `message(name)` for the first choice that is not None; no effect if all are.

    `reason` completes the hint "Leave `<name>` out: <reason>."; None: no hint.
    """
    for name, value in chosen.items():
        if value is not None:
            raise ConfigError(message(name), hint=reason and f"Leave `{name}` out: {reason}.")


def _ranges(variation: Any) -> dict[str, Any]:
    """Return `{"variation": ranges}` with checked plain numbers by name; empty for None."""
    if variation is None:
        return {}
    from home_mjx.tasks.variation.ranges import normalize_ranges

    return {"variation": normalize_ranges(variation)}


def _episode_rows(file: Path, bank: "HouseBank", task: Any) -> Any:
    """Load the rows of a file of episodes or tasks; `DatasetError` if all tasks are of other environments."""
    from home_mjx.tasks.env.episodes import load_episodes_or_tasks
    from home_mjx.tasks.rules.task_bank import TaskBank

    rows = load_episodes_or_tasks(file, bank, task)
    if isinstance(rows, TaskBank):
        own = [generator.name for generator in task.generators]
        others = [name for name in rows.names if name in task_names()]
        if others and not set(rows.names) & set(own):
            message = f"file contains tasks of {', '.join(others)}, but not of {', '.join(own)}"
            raise DatasetError(message, file=file, element="task", hint=f"Make the environment of {others[0]}.")
    return rows
