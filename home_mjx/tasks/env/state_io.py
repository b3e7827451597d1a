"""States on disk, to inspect faults and to resume."""

import dataclasses
from contextlib import suppress
from pathlib import Path
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax.typing import ArrayLike

from home_mjx.core.files import as_path, read_arrays, write_durably
from home_mjx.core.progress import silence
from home_mjx.errors import ConfigError, DatasetError
from home_mjx.tasks.base.state import State
from home_mjx.tasks.base.status import Status
from home_mjx.tasks.env.checks import check_state
from home_mjx.tasks.env.env import Env

SPEC_ARRAY, HOUSES_ARRAY, STATUS_ARRAY = "spec", "houses", ".status"
ACTION_ARRAY = "action"  # array name of the actions in a dump; names of state leaves begin with a dot


def save_states(path: str | Path, states: State, env: Env | None = None) -> int:
    """Write states to an `.npz` file, one array per leaf; `info` is left out.

    Args:
        path: The file.
        states: Of one environment or a batch; their keys are raw, so no typed key must be converted.
        env: The environment: its spec and the ids of its houses are stored, so that `home-mjx look` can make it again.
            None: they are not.

    Returns:
        Number of environments written.

    Raises:
        ConfigError: The file cannot be written.

    Example:
        >>> save_states("states.npz", states)  # doctest: +SKIP
        64
    """
    host = _to_host_batch(states)
    _write(path, _leaves_by_path(host) | _origin(env))
    return len(host.status)


def dump_flagged(
    path: str | Path,
    before: State,
    action: ArrayLike,
    after: State,
    flags: int = Status.NOT_A_NUMBER,
    env: Env | None = None,
) -> int:
    """Write the environments of a batch whose last step raised a flag, so that the step can be repeated.

    The state after the step is not enough: a broken step is undone, and `AutoReset` has begun the next episode there.

    Args:
        path: The file, see `load_flagged`. It is not written if no environment is flagged.
        before: The states before the step; a caller who wants to dump them must not donate them to the step.
        action: Actions of all environments.
        after: The states after the step.
        flags: Flags of `Status`; any of them counts.
        env: As for `save_states`.

    Returns:
        Number of environments written.

    Raises:
        ConfigError: The file cannot be written.

    Example:
        >>> after = step(states, actions)  # doctest: +SKIP
        >>> dump_flagged("broken.npz", states, actions, after)  # doctest: +SKIP
        1
    """
    rows = np.flatnonzero(np.asarray(after.status) & int(flags))
    if len(rows):
        arrays = _leaves_by_path(_to_host_batch(before)) | {ACTION_ARRAY: np.asarray(action)}
        _write(path, {name: values[rows] for name, values in arrays.items()} | _origin(env))
    return len(rows)


class StateOrigin(NamedTuple):
    """Environment of a file of states.

    Attributes:
        spec: Spec as JSON; "" if the file was written without it, or it cannot be represented as JSON.
        house_ids: Ids of the houses; empty if the file was written without them.
        num_envs: Number of environments in the file.
    """

    spec: str
    house_ids: tuple[str, ...]
    num_envs: int


def read_origin(path: str | Path) -> StateOrigin:
    """Read the environment of a file of states, without the states.

    Raises:
        MissingFileError: The file does not exist.
        DatasetError: The file is not one of states.

    Example:
        >>> read_origin("states.npz").num_envs  # doctest: +SKIP
        64
    """
    spec, houses, status = _read(path, [SPEC_ARRAY, HOUSES_ARRAY, STATUS_ARRAY])
    return StateOrigin(str(spec), tuple(map(str, houses)), len(status))


def load_flagged(path: str | Path, env: Env) -> tuple[State, np.ndarray]:
    """Load the states before the flagged step and their actions, as `dump_flagged` has written them.

    `env` must have the same options, houses and capacities.

    Raises:
        MissingFileError: The file does not exist.
        DatasetError: The file is malformed, has no actions, or its states are of another environment.

    Example:
        >>> states, actions = load_flagged("broken.npz", env)  # doctest: +SKIP
        >>> jax.vmap(env.step)(states, actions).status  # doctest: +SKIP
    """
    return load_states(path, env), _read(path, [ACTION_ARRAY])[0]


def load_states(path: str | Path, env: Env) -> State:
    """Load states that `save_states` has written, as a batch even if it is one state; `info` is empty.

    `env` must have the options, houses and capacities with which they were saved. Shapes, types and houses are checked;
    an option that changes none of them is not.

    Raises:
        MissingFileError: The file does not exist.
        DatasetError: The file is malformed, or its states are of another environment or of other houses.
    """
    key = jax.ShapeDtypeStruct((2,), np.uint32)
    with silence():
        like: Any = jax.eval_shape(env.core.reset, env.params, key)
    leaves, structure = jax.tree_util.tree_flatten_with_path(like.replace(info={}))
    arrays = _read(path, [jax.tree_util.keystr(place) for place, _ in leaves])
    num = arrays[0].shape[:1]
    for (place, leaf), array in zip(leaves, arrays, strict=True):
        if array.shape[1:] != leaf.shape or array.dtype != leaf.dtype:
            message = f"expected {leaf.dtype} {leaf.shape}, got {array.dtype} {array.shape[1:]}"
            hint = "Make the environment with the options that the states were saved with."
            raise DatasetError(message, file=path, element=jax.tree_util.keystr(place), hint=hint)
        if array.shape[:1] != num:
            message = f"expected {num[0]} environments, as in the first array, got {array.shape[0]}"
            raise DatasetError(message, file=path, element=jax.tree_util.keystr(place))
    states = jax.tree.unflatten(structure, [jnp.asarray(array) for array in arrays])
    try:
        check_state(env.core.template(env.bank).layout, env.params, states)
    except ConfigError as error:
        hint = "Make the environment with the houses that the states were saved with."
        raise DatasetError(error.message, file=path, element=error.element, hint=hint) from None
    return states


def _origin(env: Env | None) -> dict[str, np.ndarray]:
    """Return the arrays that `read_origin` reads: spec as JSON and ids of houses; both empty without `env`.

    The spec is also empty if one of its options has no JSON.
    """
    spec, houses = "", () if env is None else env.bank.house_ids
    if env is not None and env.spec is not None:
        with suppress(ConfigError):
            spec = dataclasses.replace(env.spec, in_memory=False).to_json()
    return {SPEC_ARRAY: np.array(spec), HOUSES_ARRAY: np.array(houses, np.str_)}


def _to_host_batch(states: State) -> State:
    """Return the states on the host, with a leading axis of environments (1 if they have none) and without `info`."""
    host = jax.tree.map(np.asarray, states.replace(info={}))
    return host if host.status.ndim == 1 else jax.tree.map(lambda x: x[None], host)


def _leaves_by_path(states: State) -> dict[str, np.ndarray]:
    """Return the arrays of states by their path in the tree, such as `.world.step`."""
    return {jax.tree_util.keystr(place): leaf for place, leaf in jax.tree_util.tree_leaves_with_path(states)}


def _write(path: str | Path, arrays: dict[str, np.ndarray]) -> None:
    """Write arrays to a compressed `.npz` file, which appears whole or not at all."""
    with write_durably(as_path(path, "states"), "states") as file:
        np.savez_compressed(file, **arrays)  # pyright: ignore[reportArgumentType]


def _read(path: str | Path, names: list[str]) -> list[np.ndarray]:
    """Return the named arrays of a file of states; `MissingFileError` or `DatasetError` if that fails."""
    return read_arrays(
        as_path(path, "states"), names, "file of states", "Name one that `save_states` or `dump_flagged` has written."
    )
