"""States on disk: to look at what went wrong, and to go on from there."""

import zipfile
from pathlib import Path
from typing import Any

import jax
import numpy as np

from home_mjx.errors import ConfigError, DatasetError, MissingFileError
from home_mjx.tasks.base.state import State
from home_mjx.tasks.environment.bound import BoundEnv


def save_states(path: str | Path, states: State, faulty_only: bool = False) -> int:
    """Writes states to an `.npz` file, one array per leaf.

    Args:
        path: The file.
        states: Of a batch; typed keys are not needed, the state keeps raw ones.
        faulty_only: Keep those environments alone whose `status` is not 0.

    Returns:
        Number of environments that were written.

    Raises:
        ConfigError: The file cannot be written.

    Example:
        >>> save_states("fault.npz", states, faulty_only=True)  # doctest: +SKIP
        1
    """
    host = jax.tree.map(np.asarray, states.replace(info={}))
    if host.status.ndim != 1:
        host = jax.tree.map(lambda x: x[None], host)
    rows = np.flatnonzero(host.status) if faulty_only else np.arange(len(host.status))
    arrays = {jax.tree_util.keystr(place): leaf[rows] for place, leaf in jax.tree_util.tree_leaves_with_path(host)}
    try:
        with Path(path).open("wb") as file:
            np.savez_compressed(file, **arrays)
    except OSError as error:
        raise ConfigError(f"states cannot be written: {error.strerror}", file=path) from None
    return len(rows)


def load_states(path: str | Path, env: BoundEnv) -> State:
    """Reads what `save_states` has written.

    Args:
        path: The file.
        env: An environment of the same options and capacities.

    Raises:
        MissingFileError: There is no such file.
        DatasetError: The file is broken, or its states are of another environment.
    """
    key = jax.ShapeDtypeStruct((2,), np.uint32)
    like: Any = jax.eval_shape(env.core.reset, env.params, key)
    leaves, structure = jax.tree_util.tree_flatten_with_path(like.replace(info={}))
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = [file[jax.tree_util.keystr(place)] for place, _ in leaves]
    except FileNotFoundError:
        raise MissingFileError("there is no file of states", file=path) from None
    except (OSError, ValueError, KeyError, zipfile.BadZipFile) as error:
        raise DatasetError(f"states cannot be read: {error}", file=path) from None
    for (place, leaf), array in zip(leaves, arrays, strict=True):
        if array.shape[1:] != leaf.shape or array.dtype != leaf.dtype:
            message = f"expected {leaf.dtype} {leaf.shape}, got {array.dtype} {array.shape[1:]}"
            hint = "Make the environment with the options that the states were saved with."
            raise DatasetError(message, file=path, element=jax.tree_util.keystr(place), hint=hint)
    return jax.tree.unflatten(structure, arrays)
