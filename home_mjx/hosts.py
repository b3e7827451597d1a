"""Processes of one run on several hosts: connect them, agree on decisions, and collect arrays for files.

Every process runs the same program on its own devices; `jax.devices()` are those of all. Process 0, the leader, writes
files and decides what depends on a clock.

Example:
    >>> connect("10.0.0.1:8476", num_processes=2, process=0)  # doctest: +SKIP
    >>> is_leader()  # doctest: +SKIP
    True
"""

import re
from typing import Any, TypeVar

import jax
import numpy as np
from jax.experimental import multihost_utils

from home_mjx.errors import ConfigError

AUTO = "auto"  # coordinator that is found in the variables of a cluster, such as SLURM's
HEARTBEAT_SECONDS = 60  # [s] after which the processes beside a lost host, or one that ended by an error, end
CONNECT_SECONDS = 300  # [s] in which all processes must have connected

T = TypeVar("T")


def connect(
    coordinator: str, num_processes: int | None = None, process: int | None = None, seconds: int = CONNECT_SECONDS
) -> None:
    """Connect this process with the others, before the first use of JAX's devices; waits until all are there.

    If a process ends early, the others end with an error after `HEARTBEAT_SECONDS`. If one does not connect in time,
    JAX ends the others at once with SIGABRT.

    Args:
        coordinator: Address `HOST:PORT` of process 0, which listens there; "auto": from the variables of SLURM, Open
            MPI or another cluster that JAX knows, which have the two numbers as well. Each process then has the GPU of
            its local index there; else it has all GPUs of its host.
        num_processes: Number of processes.
        process: Index of this process, from 0.
        seconds: Maximum time to wait for the others [s].

    Raises:
        ConfigError: An argument is missing or wrong, or no cluster is found.
    """
    if coordinator == AUTO:
        given: dict[str, Any] = {}
    else:
        _check_address(coordinator, num_processes, process)
        given = {"coordinator_address": coordinator, "num_processes": num_processes, "process_id": process}
        given["cluster_detection_method"] = "deactivate"  # which would leave each process one GPU under SLURM
    waits: dict[str, Any] = {
        "heartbeat_timeout_seconds": HEARTBEAT_SECONDS,
        "shutdown_timeout_seconds": HEARTBEAT_SECONDS,
    }
    try:
        jax.distributed.initialize(**given, **waits, initialization_timeout=seconds)
    except (RuntimeError, ValueError) as error:
        hint = "Pass --coordinator HOST:PORT, --processes and --process; or start by srun with --coordinator auto."
        raise ConfigError(f"cannot connect the processes: {error}", hint=hint) from error


def _check_address(coordinator: str, num_processes: int | None, process: int | None) -> None:
    """Raise `ConfigError` unless the address is `HOST:PORT`, and `process` is an index below `num_processes`."""
    if not re.fullmatch(r"[^\s:]+:\d{1,5}|\[[0-9a-fA-F:]+\]:\d{1,5}", coordinator):
        hint = "Write HOST:PORT, such as 10.0.0.1:8476, or auto."
        raise ConfigError(f"coordinator is no address: {coordinator!r}", element="coordinator", hint=hint)
    if num_processes is None or process is None:
        hint = "Pass --processes, their number, and --process, the index of each from 0."
        raise ConfigError("an address of a coordinator needs the number of processes and an index", hint=hint)
    if not 0 <= process < num_processes:
        raise ConfigError(f"process must be from 0 to {num_processes - 1}, got {process}", element="process")


def num_processes() -> int:
    """Return the number of connected processes; 1 without `connect`."""
    return jax.process_count()


def is_leader() -> bool:
    """Return whether this is process 0, or the only one."""
    return jax.process_index() == 0


def agree(values: T) -> T:
    """Return the leader's numbers, from all processes; a single process returns its own.

    All processes must call it at the same place. `values` is a pytree of numbers or arrays.
    """
    return values if num_processes() == 1 else multihost_utils.broadcast_one_to_all(values)


def check_same(value: int, what: str, hint: str) -> None:
    """Raise `ConfigError` in every process unless all have the same number; all must call it at the same place.

    Args:
        value: The number, of 32 bits.
        what: What it is, for the message.
        hint: What to do.
    """
    if num_processes() == 1:
        return
    found = np.asarray(multihost_utils.process_allgather(np.int32(value))).tolist()
    if len(set(found)) > 1:
        raise ConfigError(f"processes have different {what}: {', '.join(map(str, found))}", hint=hint)


def collect(tree: T) -> T:
    """Return arrays of all devices as whole arrays, in every process; in a single process the tree itself."""
    return tree if num_processes() == 1 else jax.tree.map(_whole, tree)


def local_part(tree: T) -> T:
    """Return this process's first part of each array over several processes; others stay.

    That is the whole of a replicated array, and of one that is split over devices the part of one device.
    """
    return jax.tree.map(lambda x: x if _is_local(x) else x.addressable_data(0), tree)


def _whole(x: Any) -> Any:
    """Return an array over several processes as one NumPy array; others stay."""
    return x if _is_local(x) else multihost_utils.process_allgather(x, tiled=True)


def _is_local(x: Any) -> bool:
    """Return whether all parts of an array are on devices of this process; True for other values."""
    return not isinstance(x, jax.Array) or x.is_fully_addressable
