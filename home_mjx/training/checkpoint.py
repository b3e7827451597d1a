"""Checkpoints of training: one atomically written file each, with the run's configuration inside."""

import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import jax
import numpy as np

from home_mjx.core.files import as_path, read_arrays, write_durably
from home_mjx.core.jsonable import TUPLE, from_json, to_json
from home_mjx.errors import ConfigError, DatasetError
from home_mjx.hosts import collect, is_leader
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.training.config import RunConfig
from home_mjx.training.ppo import PPO
from home_mjx.training.rollout import Policy

CHECKPOINT_FILE = "checkpoint.npz"  # file name in the folder of a run
AGENT_FILE = "agent.npz"  # file name of the final network alone, in the same folder
CLONED_FILE = "cloned.npz"  # file name of the network after cloning, before PPO
CONFIG_KEY = "config"  # key of the configuration in a file; keys of arrays begin with a dot
NET_PREFIX = ".net"  # key prefix of the parameters of a `TrainState`
MAX_SHOWN_DIFFERENCES = 5  # maximum number of differences that an error names
FREE_SPACE_HINT = "Free some space, then continue with --resume; or choose another folder with --out."
DIVERGED_HINT = "Training has diverged; try a lower learning rate, such as --ppo learning_rate=0.0001."
CHECKPOINT_HINT = "Pass the folder of a `home-mjx train` run, its checkpoint.npz or its agent.npz."


def save_checkpoint(path: str | Path, state: Any, config: RunConfig) -> None:
    """Write a `TrainState` to a temporary file and rename it, so that a killed process leaves the old checkpoint.

    Of several processes every one calls it, and the leader writes the file.

    Args:
        path: The file, an `.npz` of one array per leaf.
        state: The state, of any number of hosts and devices.
        config: Configuration of the run, stored in the file.

    Raises:
        ConfigError: The file cannot be written, or the configuration does not consist of numbers, text and dataclasses.
    """
    whole = collect(state)
    if is_leader():
        _save(as_path(path, "a checkpoint"), _arrays_by_path(whole), config)


def save_net(path: str | Path, net: Any, config: RunConfig) -> None:
    """Write the parameters `net` alone, as compressed float16, for `load_net` and `read_config`.

    The file has less than a tenth of a checkpoint's size. Of several processes the leader writes it.

    Numbers beyond the range of float16 become inf, which `load_net` refuses.

    Raises:
        ConfigError: As in `save_checkpoint`.
    """
    if not is_leader():
        return
    half = jax.tree.map(lambda x: np.asarray(x).astype(np.float16), net)
    arrays = {NET_PREFIX + name: x for name, x in _arrays_by_path(half).items()}
    _save(as_path(path, "a checkpoint"), arrays, config, is_compressed=True)


def _arrays_by_path(tree: Any) -> dict[str, np.ndarray]:
    """Return the leaves as NumPy arrays by key path, such as `.net['params']['bias']`."""
    return {jax.tree_util.keystr(place): np.asarray(x) for place, x in jax.tree_util.tree_leaves_with_path(tree)}


def _save(path: Path, arrays: dict[str, np.ndarray], config: RunConfig, is_compressed: bool = False) -> None:
    """Write arrays by name and the configuration, durably; raises as `save_checkpoint`."""
    write: Callable[..., None] = np.savez_compressed if is_compressed else np.savez
    text = np.array(to_json(config))
    with write_durably(path, "checkpoint", FREE_SPACE_HINT) as file:
        write(file, **{CONFIG_KEY: text}, **arrays)


def load_checkpoint(path: str | Path, like: Any, config: RunConfig) -> Any:
    """Load the `TrainState` of a file, to be passed to `PPO.to_devices`; `like` is not changed.

    Args:
        path: The file.
        like: A state of the same shapes and types, or their `jax.eval_shape`.
        config: The configuration to continue with.

    Raises:
        ConfigError: The checkpoint has another configuration; the error names the differences. Or as in `read_config`.
        MissingFileError: The file does not exist.
        DatasetError: The file is not a checkpoint, arrays are missing or have other shapes or types, or parameters are
            not finite.
    """
    check_same_config(read_config(path), config, path)
    return _load_tree(path, like, "")


def load_net(path: str | Path, like: Any) -> Any:
    """Load the parameters, with shapes and types of `like`, from a checkpoint or a file of `save_net`.

    Raises:
        MissingFileError: The file does not exist.
        DatasetError: The file is not a checkpoint, or its parameters are missing, not finite, or have other shapes or
            types; float16 is accepted for float32.
    """
    return _load_tree(path, like, NET_PREFIX)


def load_policy(path: str | Path, core: HouseholdEnv, greedy: bool = False) -> tuple[Callable[[Any], Policy], Any]:
    """Load a trained agent for an environment with the observations and actions that it was trained on.

    Args:
        path: A checkpoint, or a file of `save_net`.
        core: The environment's functions.
        greedy: Take the most likely action instead of sampling.

    Returns:
        A function from parameters to a policy, and the parameters: the arguments of `evaluate`.

    Raises:
        ConfigError: As in `read_config`, or the environment's observations or actions have no network, see `PPO`.
        MissingFileError: The file does not exist.
        DatasetError: As in `load_net`, for example for other observations or actions.

    Example:
        >>> results = evaluate(held_out, *load_policy("runs/PointNav-v0/agent.npz", held_out.core))  # doctest: +SKIP
    """
    ppo = PPO(core, read_config(path).ppo, jax.devices()[:1])
    net = load_net(path, jax.eval_shape(ppo.agent.init_net, jax.random.key(0)))
    return lambda net: ppo.policy(net, greedy), net


def read_updates(path: str | Path) -> int:
    """Read the number of updates of a run so far from its checkpoint, which a file of `save_net` does not have.

    Raises:
        MissingFileError: The file does not exist.
        DatasetError: The file is no such checkpoint.
    """
    (updates,) = _read_checked(path, [".updates"])
    if updates.shape or updates.dtype.kind != "i" or updates < 0:
        message = f"expected a whole number of at least 0, got {updates.dtype} {updates!s:.40}"
        raise DatasetError(message, file=path, element=".updates", hint=CHECKPOINT_HINT)
    return int(updates)


def read_config(path: str | Path) -> RunConfig:
    """Read the configuration of the run that wrote a checkpoint.

    Raises:
        MissingFileError: The file does not exist.
        DatasetError: The file is not a checkpoint.
        ConfigError: Its configuration cannot be read by this version, or its environment is not registered here.
    """
    (text,) = _read_checked(path, [CONFIG_KEY])
    config = from_json(str(text), Path(path))
    if not isinstance(config, RunConfig):
        raise DatasetError("file is not a training checkpoint", file=path, hint=CHECKPOINT_HINT)
    return config


def check_same_config(theirs: RunConfig, ours: RunConfig, path: str | Path) -> None:
    """Raise `ConfigError` if a checkpoint has another configuration than this run.

    The message names at most `MAX_SHOWN_DIFFERENCES` of the options that differ. An option that one of them lacks
    counts as None there.
    """
    there, here = (dict(_flat(json.loads(to_json(config)), "")) for config in (theirs, ours))
    wrong = [name for name in {**there, **here} if there.get(name) != here.get(name)]
    if wrong:
        shown = "; ".join(
            f"`{name}` is {there.get(name)} there, {here.get(name)} here" for name in wrong[:MAX_SHOWN_DIFFERENCES]
        )
        more = f"; and {len(wrong) - MAX_SHOWN_DIFFERENCES} more" if len(wrong) > MAX_SHOWN_DIFFERENCES else ""
        message = f"checkpoint has another configuration: {shown}{more}"
        raise ConfigError(message, file=path, hint="Pass the same options, or train into another folder.")


def _flat(value: Any, name: str) -> Iterator[tuple[str, Any]]:
    """Yield dotted names, after `name`, and values of all leaves of nested dicts and lists, as of `to_json`.

    Items of lists and tuples have their index as name; empty ones yield nothing.
    """
    if not isinstance(value, dict | list):
        yield name, value
        return
    for key, x in value.items() if isinstance(value, dict) else enumerate(value):
        yield from _flat(x, name if key == TUPLE else f"{name}.{key}".removeprefix("."))


def is_finite(net: Any) -> bool:
    """Return whether all parameters are finite, also if there are none; after diverged training they are not.

    Example:
        >>> is_finite({"bias": np.zeros(3), "scale": np.array(np.nan)})
        False
    """
    return all(bool(np.isfinite(np.asarray(x)).all()) for x in jax.tree.leaves(net))


def _load_tree(path: str | Path, like: Any, below: str) -> Any:
    """Load a tree with the structure, shapes and types of `like`; `below` begins the names of its arrays in the file.

    Raises as `load_net`. Further arrays of the file are ignored. Float16 arrays become float32 where `like` has
    float32. Only parameters must be finite.
    """
    leaves, structure = jax.tree_util.tree_flatten_with_path(like)
    names = [below + jax.tree_util.keystr(place) for place, _ in leaves]
    arrays = _read_checked(path, names)
    for name, (_, leaf), array in zip(names, leaves, arrays, strict=True):
        kinds = (leaf.dtype, np.dtype(np.float16)) if leaf.dtype == np.float32 else (leaf.dtype,)
        if array.shape != leaf.shape or array.dtype not in kinds:
            message = f"expected {leaf.dtype} {leaf.shape}, got {array.dtype} {array.shape}"
            hint = "Made with other sensors, actions or networks, houses of another capacity, or another version."
            raise DatasetError(message, file=path, element=name, hint=hint)
        if name.startswith(NET_PREFIX) and not is_finite(array):
            raise DatasetError("network has numbers that are not finite", file=path, element=name, hint=DIVERGED_HINT)
    whole = [array.astype(leaf.dtype, copy=False) for array, (_, leaf) in zip(arrays, leaves, strict=True)]
    return jax.tree.unflatten(structure, whole)


def _read_checked(path: str | Path, names: list[str]) -> list[np.ndarray]:
    """Read arrays by name; raise `MissingFileError` or `DatasetError` as `read_config`."""
    return read_arrays(as_path(path, "a checkpoint"), names, "checkpoint", CHECKPOINT_HINT)
