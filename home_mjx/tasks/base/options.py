"""Options by name (flat, dotted, or whole records) for nested frozen dataclasses."""

import dataclasses
import functools
import numbers
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, NoReturn

from home_mjx.core.variants import nested_names, replace_variant, variants_of
from home_mjx.errors import ConfigError, UnknownNameError, did_you_mean
from home_mjx.raycast_render.shaders.base import resolve_shader
from home_mjx.tasks.base.config import DiscreteActions, EnvConfig

# Option names of 0.1.0 and their replacements.
RENAMED_OPTIONS = {
    "agent_radius": "body.radius",
    "agent_height": "body.height",
    "agent_mass": "body.mass",
    "limit": "num_houses",
}
DISCRETE_ACTION_HINT = (
    "It is an option of discrete actions: actions=home_mjx.tasks.DiscreteActions(forward_step_size=0.25, ...); on the "
    """command line, --env 'actions={"forward_step_size": 0.25}'."""
)
SUCCESS_OPTION_HINT = "Tasks whose goal is a point, an object or a sound have `success_distance`."
HOUSES_HINT = "Give `houses`, such as the folder of a dataset, `num_houses` and `split`."
# Option names of other simulators and their counterparts here.
FOREIGN_OPTION_HINTS = {
    "num_envs": "Batch with `jax.vmap` over keys, with `AutoReset`, or with `gymnasium.make_vec(..., num_envs=...)`.",
    "seed": "Randomness comes from the key of `reset(key)`.",
    "image_size": "Give `width` and `height`.",
    "resolution": "Give `width` and `height`.",
    "max_episode_steps": "Give `episode_length`.",
    "horizon": "Give `episode_length`.",
    "gps": "It is a sensor: sensors=(..., 'gps_compass').",
    "compass": "It is a sensor: sensors=(..., 'gps_compass').",
    "hfov": "Give `fovy`, the vertical field of view.",
    "fov": "Give `fovy`, the vertical field of view.",
    "render_mode": "It is an option of the Gymnasium adapter: gymnasium.make('home_mjx/...', render_mode='rgb_array').",
    "forward_step_size": DISCRETE_ACTION_HINT,
    "turn_angle": DISCRETE_ACTION_HINT,
    "tilt_angle": DISCRETE_ACTION_HINT,
    "success_radius": SUCCESS_OPTION_HINT,
    "success_distance": SUCCESS_OPTION_HINT,
    "goal_radius": SUCCESS_OPTION_HINT,
    "scenes": HOUSES_HINT,
    "scene": HOUSES_HINT,
    "dataset": HOUSES_HINT,
    "data_path": HOUSES_HINT,
    "frame_skip": "Give `ctrl_dt` and `sim_dt`.",
    "dt": "Give `ctrl_dt` (environment step) or `sim_dt` (physics step).",
}
# Compiler options that follow from the environment's body, so they cannot be set by name.
DERIVED_OPTIONS = {"compile.navigation.agent_radius", "compile.navigation.agent_height"}

Records = Mapping[str, Any]  # frozen dataclasses by prefix; "" is the environment's


def override_options(records: Records, given: Mapping[str, Any], accepted: Iterable[str] = ()) -> dict[str, Any]:
    """Return copies of the records, by prefix, with some of their fields replaced.

    Args:
        records: By prefix; "" is the environment's, whose own fields need no prefix.
        given: Values by name: `width`, `physics.friction_corner`, or a whole record as in `physics=PhysicsConfig()`.
            A flat name matches a field at any depth if only one field has that name. A whole record is set first, then
            its fields; of several names of one field the last counts.
        accepted: Further names that the caller accepts, as suggestions for unknown names.

    Raises:
        ConfigError: A name is unknown (with the closest known one) or matches several fields, a value is invalid, or
            no move fits into the requested `ctrl_dt`.

    Example:
        >>> override_options({"": EnvConfig()}, {"width": 32, "physics.num_agents": 2, "friction": 0.5})[
        ...     ""
        ... ].physics.friction
        0.5
    """
    known = {path: prefix for prefix, record in records.items() for path in _field_paths(record, prefix)}
    changes: dict[str, dict[str, Any]] = {prefix: {} for prefix in records}
    for name, value in given.items():
        path = _resolve_path(name, known, accepted, given.get("shader"))
        changes[known[path]][path.removeprefix(known[path]).removeprefix(".")] = value
    made = {prefix: _replace_fields(record, changes[prefix], prefix) for prefix, record in records.items()}
    _check_clock(changes.get("", {}), made.get(""))
    return made


def _check_clock(asked: Mapping[str, Any], config: Any) -> None:
    """Raise `ConfigError` if a requested `ctrl_dt` was lengthened for the moves: only the default one may be."""
    wanted = asked.get("timing.ctrl_dt")
    if wanted is not None and config.timing.ctrl_dt != wanted:
        raise ConfigError(
            f"no move of `actions` fits into a step of {wanted:g} s",
            hint="Make `ctrl_dt` longer, the moves of `actions` smaller, or the body's speeds higher.",
        )


def make_config(**options: Any) -> EnvConfig:
    """Return an `EnvConfig` from options by name, see `override_options`.

    Raises:
        ConfigError: An option is unknown (with the closest known one) or invalid.

    Example:
        >>> make_config(width=32, num_agents=2).physics.num_agents
        2
    """
    return override_options({"": EnvConfig()}, options)[""]


def _field_paths(record: Any, prefix: str, shared: frozenset[str] = frozenset()) -> Iterator[str]:
    """Yield `prefix` (unless empty) and the dotted paths of all nested fields, and of the fields of all variants.

    Of nested `timing` only the outermost one is a path; `DERIVED_OPTIONS` are left out, and so are fields named in
    `shared`.
    """
    if prefix:
        yield prefix
    own = {field.name for field in dataclasses.fields(record)}
    for field in dataclasses.fields(record):
        path = f"{prefix}.{field.name}" if prefix else field.name
        if field.name in shared or path in DERIVED_OPTIONS:
            continue
        value, variants = getattr(record, field.name), variants_of(record, field.name)
        if variants:
            yield path
            yield from (f"{path}.{name}" for name in nested_names(record, field.name))
        elif dataclasses.is_dataclass(value):
            yield from _field_paths(value, path, shared | (own & {"timing"}))
        else:
            yield path


def _resolve_path(name: str, known: Mapping[str, str], others: Iterable[str], shader: Any = None) -> str:
    """Return the full dotted path that an option name refers to; `ConfigError` if it is unknown or ambiguous.

    A full path wins over fields of that name at other depths, except those of the task. The keys of `known` are all
    paths; `others` are further names to suggest. `shader` is the value of that option; None if it is not given.
    """
    found = [path for path in known if path.rpartition(".")[2] == name]
    if name in known and not any(known[path] == "task" for path in found if path != name):
        return name
    if not found:
        _raise_unknown(name, known, others, shader)
    if len(found) > 1:  # a task's option that shares a name must not be ignored silently
        raise ConfigError(f"the option `{name}` could be any of {', '.join(found)}", hint="Write one of them in full.")
    return found[0]


def _raise_unknown(name: str, known: Iterable[str], others: Iterable[str], shader: Any) -> NoReturn:
    """Raise the error for an unknown option: its new name, a hint for other simulators' names, or the closest name.

    With a shader, the hint also names the options of that shader; an unknown shader raises its own error.
    """
    if name in RENAMED_OPTIONS:
        raise ConfigError(f"the option `{name}` is now `{RENAMED_OPTIONS[name]}`")
    short = [path.rpartition(".")[2] for path in known]
    everything = {*known, *others, *(word for word in short if short.count(word) == 1)}
    hint = FOREIGN_OPTION_HINTS.get(name) or did_you_mean(name, everything)
    raise UnknownNameError(
        f"unknown option `{name}`", hint=hint if shader is None else _shader_hint(name, shader, hint)
    )


def _shader_hint(name: str, spec: Any, hint: str) -> str:
    """Return the hint for an option that `make` does not know, beside a shader: how to set it, or which options exist.

    Example:
        >>> _shader_hint("num_lights", "lit", "")
        'It is an option of the shader: shader=LitShader(num_lights=...).'
    """
    shader = resolve_shader(spec)
    title, own = type(shader).__name__, [field.name for field in dataclasses.fields(shader)]  # pyright: ignore
    if name in own:
        return f"It is an option of the shader: shader={title}({name}=...)."
    options = f"the options {', '.join(own)}, as in shader={title}({own[0]}=...)" if own else "no options"
    known = f"The shader `{shader.name}` has {options}."
    return f"{known} {hint}" if hint.startswith("Known") else f"{hint}. {known}"


def _replace_fields(record: Any, changes: Mapping[str, Any], full: str) -> Any:
    """Return a copy with values by path relative to `record` ("": a whole record), set together; `full` names it."""
    if "" in changes:
        record = _check_record_type(full, changes[""], record)
    below: dict[str, dict[str, Any]] = {}
    for path, value in changes.items():
        name, _, rest = path.partition(".")
        if name:
            below.setdefault(name, {})[rest] = value
    values = {name: _replace_field(record, name, parts, f"{full}.{name}".lstrip(".")) for name, parts in below.items()}
    replace = getattr(record, "replace", None) or functools.partial(dataclasses.replace, record)
    return replace(**values) if values else record


def _replace_field(record: Any, name: str, changes: Mapping[str, Any], full: str) -> Any:
    """Return the new value of a field from values by path below it ("": the whole field); `full` names it."""
    old, variants = getattr(record, name), variants_of(record, name)
    if variants:
        return replace_variant(full, variants, old, changes)
    if dataclasses.is_dataclass(old):
        return _replace_fields(old, changes, full)
    value = changes[""]
    if full == "actions" and isinstance(value, Mapping):  # from JSON
        return override_options({"": DiscreteActions()}, value)[""]
    if full.startswith("task."):  # other records validate themselves, with better messages
        _check_like(full, value, old)
    return tuple(value) if isinstance(value, list) else value  # options must be hashable


def _check_like(name: str, value: Any, default: Any) -> None:
    """Raise `ConfigError` if a value lacks the type of a bool, int, float or str `default`; other defaults accept all.

    Floats accept integers; numbers do not accept booleans.
    """
    wanted = type(default)
    taken = {bool: bool, int: numbers.Integral, float: numbers.Real, str: str}.get(wanted)
    if taken is None:
        return
    if not isinstance(value, taken) or isinstance(value, bool) != (wanted is bool):
        raise ConfigError(f"`{name}` must be a {wanted.__name__}, got {value!r}")


def _check_record_type(name: str, value: Any, old: Any) -> Any:
    """Return a record if it is of the type of `old`; else raise `ConfigError`."""
    if not isinstance(value, type(old)):
        raise ConfigError(f"`{name}` must be a {type(old).__name__}, got {value!r}")
    return value
