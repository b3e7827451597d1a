"""Light and glow of lamps and appliances by their states."""

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.bank.bank import HouseBank
from home_mjx.bank.records import SWITCH_KINDS
from home_mjx.raycast_render.scene.appearance import AppearanceOverrides

KIND_GLOW = {"lamp": 0.6, "television": 0.6, "radio": 0.1}  # emission of surfaces of what is on, from 0 to 1
LUMINANCE = (0.2126, 0.7152, 0.0722)  # ITU-R BT.709


def switch_lights(
    bank: HouseBank, house: Int[Array, ""], on: Bool[Array, " s"], look: AppearanceOverrides | None
) -> AppearanceOverrides:
    """Return overrides `look` with the light and glow of these states; other fields stay.

    Direct light of each lamp is exact. Indirect light of a room, of one bake for all states, is scaled by the share of
    its lamps' flux that is on. Factors of lamps that the episode has already are kept.
    """
    look = AppearanceOverrides(seed=jnp.zeros((), jnp.uint32)) if look is None else look
    lights, of_light = bank.lights, bank.switches.of_light[house]
    lit = jnp.where(of_light < 0, 1.0, on[jnp.maximum(of_light, 0)].astype(jnp.float32))
    share, room = _room_shares(bank, house, lit), lights.room[house] + 1
    kind = bank.switches.kind[house]
    glow = jnp.array([KIND_GLOW.get(name, 0.0) for name in SWITCH_KINDS], jnp.float32)[jnp.maximum(kind, 0)] * on
    instance = bank.switches.instance[house]
    place = jnp.where(instance < 0, bank.spec.num_instances, instance)
    return look.replace(
        lamps=share if look.lamps is None else share * look.lamps,
        lights=lit if look.lamps is None else lit * look.lamps[room],
        glow=jnp.zeros(bank.spec.num_instances, jnp.float32).at[place].set(glow, mode="drop"),
    )


def _room_shares(bank: HouseBank, house: Int[Array, ""], lit: Float[Array, " l"]) -> Float[Array, " rooms_and_none"]:
    """Return the share of each room's lamp flux that is on, by room + 1; of no room, that of the house. 1 without."""
    lights, count = bank.lights, bank.lights.ambient.shape[1]
    exponent, cutoff = lights.exponent[house], lights.cutoff[house]
    low = jnp.maximum(cutoff, jnp.where(exponent > 0, 0.0, -1.0))
    angle = (1 - low * jnp.abs(low) ** exponent) / (exponent + 1)  # of the angular profile, see `LightSource.intensity`
    flux = jnp.where(lights.daylight[house], 0.0, lights.intensity[house] @ jnp.asarray(LUMINANCE, jnp.float32) * angle)

    def by_room(values: Float[Array, " l"]) -> Float[Array, " rooms_and_none"]:
        """Sum values of lights by room + 1; entry 0 is the sum of all."""
        return jnp.zeros(count, jnp.float32).at[lights.room[house] + 1].add(values).at[0].set(jnp.sum(values))

    total = by_room(flux)
    return jnp.where(total > 0, by_room(flux * lit) / jnp.where(total > 0, total, 1.0), 1.0)
