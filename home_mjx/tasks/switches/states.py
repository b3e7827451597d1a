"""States of lamps and appliances, and the sensor of those around an agent."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.bank.bank import HouseBank
from home_mjx.bank.records import SWITCH_KINDS
from home_mjx.errors import ConfigError
from home_mjx.tasks.base.config import EnvConfig
from home_mjx.tasks.base.sensor import Sensor
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.base.specs import ArraySpec, Specs
from home_mjx.tasks.switches.sounds import instance_middles

LAMP = SWITCH_KINDS.index("lamp")
NOT_SWITCHABLE, OFF, ON = -1, 0, 1  # states of objects
NUM_NEARBY = 8  # things that are observed
MAX_OFFSET = 1000.0  # [m], bound of positions; larger than any house
NOTHING = -1.0  # kind and state of rows without a thing


class NearbySwitches(Sensor):
    """`nearby_switches` (8, 5): the nearest lamps and appliances: forward, left, up [m]; kind; 1 if on.

    Positions are from the middle of the agent's capsule, nearest first, also behind walls. Kinds are indices into
    `home_mjx.bank.records.SWITCH_KINDS`. Rows beyond the last thing have position 0, kind and state -1.
    """

    name = "nearby_switches"

    def spec(self, config: EnvConfig) -> Specs:
        """Return the spec of `nearby_switches`.

        Raises:
            ConfigError: The environment has no states of lamps and appliances.
        """
        if config.switches is None:
            message = "`nearby_switches` needs states of lamps and appliances"
            raise ConfigError(message, element="sensors", hint='Give switches="random".')
        high = (*[MAX_OFFSET] * 3, len(SWITCH_KINDS) - 1.0, 1.0)
        low = (*[-MAX_OFFSET] * 3, NOTHING, NOTHING)
        text = "nearest lamps and appliances: forward, left, up [m], kind, 1 on; -1 none"
        return {"nearby_switches": ArraySpec((NUM_NEARBY, 5), "float32", low, high, text)}

    def observe(self, config: EnvConfig, snapshot: Snapshot, state: tuple) -> dict[str, Array]:
        """Return `nearby_switches` (a, 8, 5)."""
        switches, house, on = snapshot.bank.switches, snapshot.house, snapshot.switch_on
        assert on is not None
        kind, middle = switches.kind[house], instance_middles(snapshot.scene, jnp.maximum(switches.instance[house], 0))
        count = min(NUM_NEARBY, kind.shape[0])

        def one(pos: Float[Array, "3"], yaw: Float[Array, ""]) -> Float[Array, "8 5"]:
            """Return the rows of one agent."""
            way, cos, sin = middle - pos, jnp.cos(yaw), jnp.sin(yaw)
            x, y, z = way.T
            table = jnp.stack([cos * x + sin * y, cos * y - sin * x, z, kind.astype(jnp.float32), on], axis=1)
            empty = jnp.array([0.0, 0.0, 0.0, NOTHING, NOTHING], jnp.float32)
            away = jnp.where(kind >= 0, jnp.linalg.norm(way, axis=1), jnp.inf)
            nearest = jnp.argsort(away, stable=True)[:count]
            rows = jnp.where((kind >= 0)[:, None], table, empty)[nearest]
            return jnp.concatenate([rows, jnp.broadcast_to(empty, (NUM_NEARBY - count, 5))])

        return {"nearby_switches": jax.vmap(one)(snapshot.pose.pos, snapshot.pose.yaw)}


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
