"""Resets and steps in parts, so that what agents see and hear is compiled once for both."""

import functools
from collections.abc import Callable
from typing import Any

import jax

from home_mjx import HouseholdEnv


def parted(core: HouseholdEnv, batched: bool = False) -> tuple[Callable[..., Any], Callable[..., Any]]:
    """Return `reset(params, key, house, episode)` and `step(params, state, action)`, of one environment or a batch."""

    def program(function: Callable[..., Any]) -> Callable[..., Any]:
        if not batched:
            return jax.jit(function)
        return jax.jit(lambda params, *args: jax.vmap(functools.partial(function, params))(*args))

    begin = program(functools.partial(core.reset, observe=False))
    advance = program(functools.partial(core.step, observe=False))
    look = program(functools.partial(core.observe, update=True))
    return (lambda params, *args: look(params, begin(params, *args))), (
        lambda params, *args: look(params, advance(params, *args))
    )
