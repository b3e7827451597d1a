"""States of what can be switched."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Int

from home_mjx.bank.bank import HouseBank
from home_mjx.bank.records import SWITCH_KINDS
from home_mjx.errors import ConfigError
from home_mjx.tasks.base.config import EnvConfig

LAMP = SWITCH_KINDS.index("lamp")
NOT_SWITCHABLE, OFF, ON = -1, 0, 1  # states of objects


def sample_switches(config: EnvConfig, bank: HouseBank, house: Int[Array, ""], key: Array) -> Bool[Array, " s"] | None:
    """Return which things are on at reset, by `config.switches`; padding is off. None without the option.

    Raises:
        ConfigError: No house of the bank has anything to switch.
    """
    if config.switches is None:
        return None
    kind = bank.switches.kind[house]
    if not kind.shape[0]:
        hint = "Leave out `switches`, or give houses with lamps, such as procedural:8."
        raise ConfigError("`switches` is given, but no house has anything to switch", hint=hint)
    on = {
        "initial": kind == LAMP,
        "on": jnp.ones_like(kind, bool),
        "off": jnp.zeros_like(kind, bool),
        "random": jax.random.bernoulli(key, 0.5, kind.shape),
    }[config.switches]
    return on & (kind >= 0)


def object_states(bank: HouseBank, house: Int[Array, ""], on: Bool[Array, " s"]) -> Int[Array, " i"]:
    """Return the state of each instance: `ON`, `OFF`, or `NOT_SWITCHABLE`.

    Example:
        >>> states = object_states(bank, state.world.house, state.world.switch_on)  # doctest: +SKIP
        >>> names = [("off", "on")[state] for state in states.tolist() if state >= 0]  # doctest: +SKIP
    """
    instance, count = bank.switches.instance[house], bank.spec.num_instances
    place = jnp.where(instance < 0, count, instance)
    return jnp.full(count, NOT_SWITCHABLE, jnp.int32).at[place].set(on.astype(jnp.int32), mode="drop")
