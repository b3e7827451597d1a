"""Validation of actions, observations, banks, sounds and variation ranges."""

import logging
from collections.abc import Sequence
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from home_mjx.bank.bank import HouseBank
from home_mjx.bank.records.acoustics import LATE_REVERB
from home_mjx.core.checks import check_number
from home_mjx.errors import MAX_LISTED, ConfigError, OutOfRangeError
from home_mjx.houses.bakes import Bake
from home_mjx.physics.base.layout import Layout
from home_mjx.tasks.base.config import EnvConfig
from home_mjx.tasks.base.specs import Specs
from home_mjx.tasks.base.state import EnvParams, State
from home_mjx.tasks.base.task import Task
from home_mjx.tasks.rules.declaration import extract
from home_mjx.tasks.rules.task_bank import TaskBank
from home_mjx.tasks.sounds.sound_events import VOICE_CLIP, SoundEvents, clip_name
from home_mjx.tasks.variation.ranges import Variation

MAX_FOVY = 179.0  # [degrees], maximum field of view
# Ranges of lights, and the field of `AppearanceOverrides` that each sets.
LIGHT_RANGES = {
    "lamps": "lamps",
    "lamp_gain": "lamps",
    "daylight": "daylight",
    "sun_azimuth": "sun_azimuth",
    "sun_elevation": "sun_elevation",
}

log = logging.getLogger(__name__)


def clip_action(action: Any, num_agents: int, size: int) -> tuple[Float[Array, "a n"], Bool[Array, ""]]:
    """Return continuous actions of all agents clipped to [-1, 1], NaN as 0; and whether any was changed.

    Integers are converted; booleans are no real numbers.

    Raises:
        ConfigError: Not real numbers, or a wrong shape.
    """
    action = _as_array(action)
    if not jnp.issubdtype(action.dtype, jnp.floating) and not jnp.issubdtype(action.dtype, jnp.integer):
        raise ConfigError(f"expected real numbers as action, got {action.dtype}")
    action = _add_agent_axis(action, num_agents, (size,)).astype(jnp.float32)
    usable = jnp.clip(jnp.where(jnp.isnan(action), 0.0, action), -1.0, 1.0)
    return usable, jnp.any(usable != action)


def validate_choice(action: Any, num_agents: int, count: int) -> tuple[Int[Array, " a"], Bool[Array, ""]]:
    """Return discrete actions of all agents, with `count` for invalid ones; and whether there are any.

    Valid actions are 0 to `count` - 1.

    Raises:
        ConfigError: Not integers, or not one per agent.
    """
    action = _as_array(action)
    if not jnp.issubdtype(action.dtype, jnp.integer):
        hint = "Discrete actions are numbered; `action_spec.text` has their names."
        raise ConfigError(f"expected an integer as action, got {action.dtype}", hint=hint)
    action = _add_agent_axis(action, num_agents, ())
    known = (action >= 0) & (action < count)
    return jnp.where(known, action, count).astype(jnp.int32), jnp.any(~known)


def check_choice(action: Any, names: Sequence[str]) -> None:
    """Raise `OutOfRangeError` if a discrete action (an index into `names`) does not exist; it names the first such.

    Do nothing inside `jit`, for dictionaries and for what is not an integer.

    Example:
        >>> check_choice(jnp.int32(9), ("stop", "move_forward"))
        Traceback (most recent call last):
        ...
        home_mjx.errors.OutOfRangeError: there is no action 9. Give a number from 0 to 1: 0 stop, 1 move_forward
    """
    if isinstance(action, jax.core.Tracer | dict):  # pyright: ignore[reportAttributeAccessIssue]
        return
    numbers = np.atleast_1d(np.asarray(action))
    wrong = numbers[(numbers < 0) | (numbers >= len(names))]
    if numbers.dtype.kind in "iu" and len(wrong):
        listed = ", ".join(f"{number} {name}" for number, name in enumerate(names[:MAX_LISTED]))
        more = ", …" if len(names) > MAX_LISTED else ""
        hint = f"Give a number from 0 to {len(names) - 1}: {listed}{more}"
        raise OutOfRangeError(f"there is no action {wrong[0]}", hint=hint)


def _as_array(action: Any) -> Array:
    """Return an action as a JAX array; `ConfigError` for a dictionary."""
    if isinstance(action, dict):
        raise ConfigError(f"expected an array of actions, got a dictionary of {', '.join(map(str, action))}")
    return jnp.asarray(action)


def _add_agent_axis(action: Array, num_agents: int, shape: tuple[int, ...]) -> Array:
    """Return the action as (agents, *shape); the agent axis is optional for one agent, `shape` that of one action.

    Raises:
        ConfigError: The action has another shape, such as that of a batch of environments.
    """
    everybody = num_agents, *shape
    if action.shape not in ((everybody, shape) if num_agents == 1 else (everybody,)):
        expected = everybody if num_agents > 1 else shape
        hint = "One environment takes one action; for many, use `jax.vmap`."
        raise ConfigError(f"expected an action of shape {expected}, got {action.shape}", hint=hint)
    return action.reshape(everybody)


def check_task_options(config: EnvConfig, task: Task) -> None:
    """Raise if a task needs actions or agents that the environment does not have.

    Raises:
        ConfigError: The task needs `stop` or words but actions are continuous, or hands that are disabled. Or the
            number of agents does not fit.
    """
    name, discrete = type(task).__name__, config.discrete is not None
    if task.requires_hands and not config.hands:
        raise ConfigError(f"{name} needs hands, which agents do not have", hint="Give hands=True.")
    if task.requires_switches and config.switches is None:
        raise ConfigError(f"{name} needs states of lamps and appliances", hint='Give switches="random".')
    if task.requires_stop and not discrete:
        message = f"{name} needs `stop`, which continuous actions do not have"
        raise ConfigError(message, hint='Give actions="discrete".')
    if (task.speech or config.speech) and not discrete:
        message = f"agents of {name} speak, which continuous actions do not let them"
        raise ConfigError(message, hint='Give actions="discrete".')
    if config.num_agents < task.min_agents:
        message = f"{name} is for {task.min_agents} agents or more, got {config.num_agents}"
        raise ConfigError(message, hint=f"Give num_agents={task.min_agents}.")
    if task.max_agents is not None and config.num_agents > task.max_agents:
        message = f"{name} is for {task.max_agents} agents, got {config.num_agents}"
        raise ConfigError(message, hint=f"Give num_agents={task.max_agents}.")
    if task.num_acting is not None:
        check_number(f"num_acting of {name}", task.num_acting, 1, config.num_agents, integer=True)


def check_bank(config: EnvConfig, bank: HouseBank, bakes: Sequence[Bake] = ()) -> None:
    """Raise if houses were compiled for another body, or lack the requested arrangements or bakes.

    Log a warning for bakes with random arrangements, which they ignore.

    Raises:
        ConfigError: Radius or height of the body differs; or there are no arrangements, or a bake is missing that a
            sensor or a shader needs.
    """
    if config.arrangement == "random":
        check_arrangements(bank)
    for bake in bakes:
        if bake.name not in bank.bakes:
            hint = f"Write bank = add_bakes(bank, houses, '{bake.name}'), or give `make` a dataset instead of a bank; "
            hint += f"a HouseStream takes bakes=('{bake.name}',)."
            if bake.name == LATE_REVERB:
                hint = f"{hint[:-1]}; or trace sound in every step with late='traced'."
            raise ConfigError(
                f"a sensor or shader needs the bake `{bake.name}`, which the bank does not have", hint=hint
            )
        if config.arrangement == "random":
            log.warning("the bake `%s` has furniture as in the files, not as arranged", bake.name)
    compiled = {name: getattr(bank.spec, f"agent_{name}") for name in ("radius", "height")}
    wrong = {name: x for name, x in compiled.items() if abs(x - getattr(config.body, name)) > 1e-6}
    if wrong:
        ours = ", ".join(f"body.{name} {getattr(config.body, name)} m" for name in wrong)
        theirs = ", ".join(f"{name} {x} m" for name, x in wrong.items())
        raise ConfigError(
            f"the environment has {ours}, but the houses were compiled for {theirs}",
            hint="Give `make` a dataset instead of a bank: it compiles for the body. "
            "Or compile the bank with NavigationOptions(agent_radius=..., agent_height=...).",
        )


def check_sounds(config: EnvConfig, tasks: Any) -> None:
    """Raise if an environment cannot play the sounds of its tasks; traced tasks and tasks other than a `TaskBank` pass.

    Voices need no clip.

    Raises:
        ConfigError: A row has more sounds, or plays another clip, than the environment can play.
    """
    if not isinstance(tasks, TaskBank) or isinstance(tasks.field, jax.core.Tracer):  # pyright: ignore
        return
    emission = extract(SoundEvents, tasks.rows.columns)
    used, clips = np.asarray(emission.emitter) >= 0, np.asarray(emission.clip)
    count = used.sum(axis=1)
    most = int(count.max(initial=0))
    if most > config.num_sources:
        raise ConfigError(
            f"tasks have up to {most} sounds at once, the environment plays {config.num_sources}",
            element=f"task {np.argmax(count)}, sounds",
            hint=f"Give num_sources={most}.",
        )
    lost = {i: clip_name(i) for i in np.unique(clips[used]).tolist()}
    lost = {i: name for i, name in lost.items() if name not in (config.clip, *config.clips, VOICE_CLIP)}
    if lost:
        names, first = ", ".join(sorted(lost.values())), np.argmax((np.isin(clips, list(lost)) & used).any(axis=1))
        message, hint = f"tasks play {names}, which the environment lacks", f"Add to clips=(...): {names}."
        raise ConfigError(message, element=f"task {first}, sounds", hint=hint)


def check_variation(config: EnvConfig, variation: Variation | None) -> None:
    """Raise if a variation has no effect, leads to impossible cameras, or plays a clip that the environment lacks.

    None and traced ones pass.

    Raises:
        ConfigError: Names the range and the remedy.
    """
    if variation is None or any(isinstance(x, jax.core.Tracer) for x in jax.tree.leaves(variation)):  # pyright: ignore
        return
    impl, shown = config.physics.impl, {field for shader in config.shaders for field in shader.overrides}
    useless = {
        **{name: None if field in shown else _shaders_hint(config) for name, field in LIGHT_RANGES.items()},
        "move_noise": None if config.discrete else 'It applies to discrete moves: give actions="discrete".',
        **dict.fromkeys(("contact_sound_volume", "footstep_distance"), _contact_sounds_hint(config)),
        "friction": f'Nothing slides with impl="{impl}": give impl="fused".' if impl in ("kinematic", "c") else None,
        "playback_rate": _PLAYBACK_HINT if "ear_levels" in (config.sensors or ()) else None,
        "mass": 'With impl="c" each house has its own model: give impl="fused".' if impl == "c" else None,
    }
    for name, reason in useless.items():
        if reason is not None and getattr(variation, name) is not None:
            raise ConfigError(f"`{name}` cannot vary here", element=f"Variation.{name}", hint=reason)
    _check_fovy(config, variation)
    _check_clips(config, variation)


_PLAYBACK_HINT = "The sensor `ear_levels` has levels of whole octaves: use `log_mel` or `interaural`."


def _shaders_hint(config: EnvConfig) -> str:
    """Return the hint about a range of lights that no shader of the cameras uses."""
    names = ", ".join(dict.fromkeys(f"`{shader.name}`" for shader in config.shaders))
    without = f"The shader {names} does not use it" if names else "No camera has the kind `rgb`"
    return f'{without}: give shader="lit", or the same to a camera with "rgb".'


def _contact_sounds_hint(config: EnvConfig) -> str | None:
    """Return the hint about ranges of contact sounds; None if they are enabled."""
    return None if config.contact_sounds else "Bodies make no sounds: give contact_sounds=ContactSoundConfig()."


def _check_fovy(config: EnvConfig, variation: Variation) -> None:
    """Raise `ConfigError` if `camera_fovy` would lead a pinhole camera out of (0, `MAX_FOVY`) degrees."""
    if variation.camera_fovy is None:
        return
    low, high = np.asarray(variation.camera_fovy).tolist()
    for view in config.all_cameras:
        if view.lens.model == "pinhole" and not 0 < view.fovy + low <= view.fovy + high < MAX_FOVY:
            text = f"{view.fovy + low:g} to {view.fovy + high:g} degrees"
            message = f"the field of view of camera `{view.name}` would be {text}"
            hint = f"It must stay between 0 and {MAX_FOVY:g}."
            raise ConfigError(message, element="Variation.camera_fovy", hint=hint)


def _check_clips(config: EnvConfig, variation: Variation) -> None:
    """Raise `ConfigError` if `clips` has a sound with positive weight that the environment lacks."""
    if variation.clips is None:
        return
    lost = {clip_name(int(i)) for i in np.flatnonzero(np.asarray(variation.clips))} - {config.clip, *config.clips}
    if lost:
        names = ", ".join(f'"{name}"' for name in sorted(lost))
        message = f"the environment lacks the sounds {names}"
        raise ConfigError(message, element="Variation.clips", hint=f"Add them to clips=(...): {names}.")


def check_arrangements(bank: HouseBank) -> None:
    """Raise `ConfigError` if a bank has no arrangements to sample from."""
    if not bank.physics.arrangement_pose.shape[1]:
        raise ConfigError(
            "random arrangements are requested, but the bank has none",
            element="EnvConfig.arrangement",
            hint="Make them: from home_mjx.tasks.arrangements import with_arrangements; "
            "bank, _ = with_arrangements(bank, 8, jax.random.key(0)). A HouseStream has none.",
        )


def check_state(layout: Layout, params: EnvParams, state: State) -> None:
    """Raise if a state is of another environment or of other houses than those of `params`.

    Numbers of coordinates are compared in every trace; fingerprints of houses only where both are known, outside of
    `jit` and `vmap`.

    Args:
        layout: Layout of the physics of the environment.
        params: Houses.
        state: State of one environment, or of a batch outside of `vmap`.

    Raises:
        ConfigError: Names the first house that differs.
    """
    hint = "Reset with the same `params` as step, or step with those of the environment that was reset."
    numbers = 4 * layout.num_agents + 7 * layout.num_bodies + layout.num_doors
    if state.physics.qpos.shape[-1] != numbers:
        message = f"the state has {state.physics.qpos.shape[-1]} coordinates, its houses and agents have {numbers}"
        raise ConfigError(f"{message}: it is of another environment", hint=hint)
    known = (params.bank.house_id, state.world.house, state.world.house_fingerprint)
    traced = any(isinstance(x, jax.core.Tracer) for x in known)  # pyright: ignore[reportAttributeAccessIssue]
    if traced or not all(isinstance(x, jax.Array | np.ndarray) for x in known):
        return
    house = np.atleast_1d(np.asarray(params.bank.clip_house_index(state.world.house)))
    own = np.asarray(jax.vmap(params.bank.fingerprint)(jnp.asarray(house)))
    foreign = np.flatnonzero(own != np.atleast_1d(np.asarray(state.world.house_fingerprint)))
    if len(foreign):
        at = house[foreign[0]]
        message = f"the state was reset in another house than {params.bank.house_ids[at]}, house {at} of the bank"
        raise ConfigError(message, element=f"environment {foreign[0]}" if state.world.house.ndim else None, hint=hint)


def check_observations(owner: object, spec: Specs, values: dict[str, Any], num_agents: int) -> None:
    """Raise unless observations of a sensor or task have the names, shapes and types of their spec, with an agent axis.

    Raises:
        ConfigError: Names, shapes or types differ.
    """
    who = f"{type(owner).__name__}.observe"
    if set(values) != set(spec):
        raise ConfigError(f"{who} returns {sorted(values)}, but its spec declares {sorted(spec)}")
    for name, value in values.items():
        expected = (num_agents, *spec[name].shape)
        if jnp.shape(value) != expected or jnp.result_type(value) != jnp.dtype(spec[name].dtype):
            raise ConfigError(
                f"{who} returns `{name}` as {jnp.result_type(value)} {jnp.shape(value)}, "
                f"but its spec declares {spec[name].dtype} {expected}",
                hint="The first axis is that of agents, also for one agent.",
            )


def check_task(task: object, before: Any, after: Any, reward: Any, terminated: Any, num_agents: int) -> None:
    """Raise unless the results of a task after a step have the shapes and the state's structure that `Task` requires.

    The state after must have the tree, shapes and types of the one before.

    Raises:
        ConfigError: A shape, or the tree, a shape or a type of its state, differs.
    """
    _check_shape(task, "reward", reward, (num_agents,))
    _check_shape(task, "terminated", terminated, ())
    shapes = [jax.tree.map(lambda x: (jnp.shape(x), jnp.result_type(x)), tree) for tree in (before, after)]
    if jax.tree.structure(before) != jax.tree.structure(after) or shapes[0] != shapes[1]:
        name = type(task).__name__
        raise ConfigError(f"{name}.update changes the structure of the task's state", hint="Keep that of `init`.")


def check_metrics(task: object, metrics: dict[str, Any]) -> dict[str, Array]:
    """Return a task's metrics unchanged if they are scalars.

    Raises:
        ConfigError: A metric is not a scalar.
    """
    for name, value in metrics.items():
        _check_shape(task, f"metrics, `{name}`", value, ())
    return metrics


def _check_shape(task: object, what: str, value: Any, shape: tuple[int, ...]) -> None:
    """Raise `ConfigError` unless a value of a task has this shape; `what` names it."""
    if jnp.shape(value) != shape:
        raise ConfigError(f"{type(task).__name__}.{what}: expected the shape {shape}, got {jnp.shape(value)}")
