"""Estimate of an environment's memory on the device."""

from dataclasses import dataclass

import jax
import jax.numpy as jnp

from home_mjx.bank.usage import bank_bytes
from home_mjx.core.checks import check_number
from home_mjx.core.progress import silence
from home_mjx.tasks.env.env import Env


@dataclass(frozen=True)
class MemoryEstimate:
    """Memory on the device [bytes], without temporary buffers of running programs.

    Attributes:
        bank: All houses, once, whatever the number of environments.
        states: The states of all environments, observations included. A step holds two of them, the one before and the
            one after, unless the caller donates the first.
        observations: Part of `states` for observations.
        state_per_env: The state of one environment.
    """

    bank: int
    states: int
    observations: int
    state_per_env: int

    @property
    def total(self) -> int:
        """Bank and two copies of the states [bytes]."""
        return self.bank + 2 * self.states

    def __str__(self) -> str:
        parts = f"bank {_text(self.bank)}, states 2 x {_text(self.states)} ({_text(self.state_per_env)} each)"
        return f"{_text(self.total)}: {parts}"


def estimate_memory(env: Env, num_envs: int) -> MemoryEstimate:
    """Estimate the memory of `num_envs` environments on the device; nothing is allocated.

    Raises:
        ConfigError: `num_envs` is not a whole number of at least 1.

    Example:
        >>> print(estimate_memory(env, 4096))  # doctest: +SKIP
        1.7 GiB: bank 49.3 MiB, states 2 x 850.1 MiB (212.5 KiB each)
    """
    check_number("num_envs", num_envs, 1, integer=True)
    with silence():
        state = jax.eval_shape(env.core.reset, env.params, jax.ShapeDtypeStruct((2,), jnp.uint32))
    each, seen = (sum(leaf.size * leaf.dtype.itemsize for leaf in jax.tree.leaves(tree)) for tree in (state, state.obs))
    return MemoryEstimate(bank_bytes(env.bank), num_envs * each, num_envs * seen, each)


def _text(count: float) -> str:
    """Format a number of bytes with one decimal and its binary unit; GiB for all from 1 GiB on."""
    for unit in ("B", "KiB", "MiB"):
        if count < 1024:
            return f"{count:.1f} {unit}"
        count /= 1024
    return f"{count:.1f} GiB"
