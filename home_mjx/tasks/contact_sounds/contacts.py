"""Blows and sliding, from contacts; doors, from how they move."""

import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.audio_jax.contact_sounds.slots import Strikes
from home_mjx.audio_jax.contact_sounds.synthesis import RUBS, STRIKES
from home_mjx.physics.base.touch import FLOOR
from home_mjx.schema.semantic import Semantic
from home_mjx.tasks.base.config import EnvConfig
from home_mjx.tasks.base.snapshot import Snapshot, touch_meaning
from home_mjx.tasks.contact_sounds.steps import stuff_class

GRAVITY = 9.81  # [m/s²]
LEAST_BLOW = 0.05  # [N s]
LEAST_CHANGE = 0.15  # [m/s] of a speed, in a step: less is no blow
LOUDEST = 30.0  # gain: 30 dB above speech for what is wooden
FLESH = 0.05  # share of an agent's blow that is heard: what it hits it hits softly
WITHIN = 0.1  # [m] of where it was hit, a body sounds
SLOWEST = 0.03  # [m/s] of what slides, so that what trembles is silent
SLIDING = 0.4  # friction of furniture on its feet
FASTEST = 3.0  # [m/s], likewise
LEAST_TURN = 0.05  # [rad/s], or [m/s] of what slides
AT_STOP = 0.02  # [rad] or [m]


def blows(
    config: EnvConfig,
    impulse: Float[Array, " m"],
    change: Float[Array, " m"],
    snapshot: Snapshot,
) -> Strikes:
    """One per mobile: the impulse of its contacts beyond what it had before, and beyond its weight.

    Two bodies that meet are heard once. Contacts of a step have no time in it: blows begin in the middle of the frame.

    Args:
        config: Options.
        impulse: Of all contacts in the step before [N s].
        change: How much the speed of each has changed in this one [m/s].
        snapshot: After it.
    """
    touch, agents, frame = snapshot.touch, config.num_agents, config.audio.frame
    number = jnp.arange(touch.impulse.shape[0], dtype=jnp.int32)
    resting = mass_of(config, snapshot) * jnp.float32(GRAVITY * config.timing.ctrl_dt)
    blow = touch.impulse - jnp.maximum(impulse, resting)
    meaning, (middle, body) = touch_meaning(snapshot.scene, touch), middles(config, snapshot)
    inwards = middle - touch.place
    far = jnp.maximum(jnp.linalg.norm(inwards, axis=1), WITHIN)[:, None]
    is_agent, by_agent = number < agents, (touch.other >= 0) & (touch.other < agents)
    told = jnp.where(is_agent, touch.other <= FLOOR, (touch.other < agents) | (touch.other > number))
    kind = jnp.where(is_agent, meaning.other[:, Semantic.MATERIAL], meaning.own[:, Semantic.MATERIAL])
    softly = jnp.where(is_agent | by_agent, FLESH, 1.0)
    there = told & (blow > LEAST_BLOW) & (change > LEAST_CHANGE)
    return Strikes(
        pos=touch.place + inwards * (WITHIN / far),  # in the body, which does not hide it, and out of what it hit
        body=body,
        row=STRIKES.index("hit_wood") + jnp.asarray(stuff_class())[kind],
        gain=jnp.where(there, jnp.minimum(softly * blow, LOUDEST), 0.0),
        start=jnp.full(number.shape, snapshot.step * frame + frame // 2, jnp.int32),
    )


def middles(config: EnvConfig, snapshot: Snapshot) -> tuple[Float[Array, "m 3"], Int[Array, " m"]]:
    """Of all mobiles [m], 0 where there is none, and their object ids."""
    moving, agents = snapshot.scene.moving, config.num_agents
    box, there = moving.box, (moving.instance >= 0)[:, None]
    pos = jnp.where(there, jnp.mean(jnp.where(there[:, None], box, 0.0), axis=1), 0.0)
    return jnp.roll(pos, agents, axis=0), jnp.roll(moving.object_id, agents)


def leaves(config: EnvConfig, snapshot: Snapshot) -> tuple[Float[Array, "h 3"], Int[Array, " h"]]:
    """Middles of doors' leaves [m], and their object ids."""
    pos, body = middles(config, snapshot)
    first = pos.shape[0] - snapshot.door_angle.shape[0]
    return pos[first:], body[first:]


def mass_of(config: EnvConfig, snapshot: Snapshot) -> Float[Array, " m"]:
    """Of mobiles that their contacts carry [kg]; doors hang."""
    bodies = snapshot.bank.physics.body_mass[snapshot.house]
    if snapshot.bodies is not None and snapshot.bodies.mass is not None:
        bodies = bodies * snapshot.bodies.mass
    agents = jnp.array([body.mass for body in config.physics.agents], jnp.float32)
    return jnp.concatenate([agents, bodies, jnp.zeros(snapshot.door_angle.shape, jnp.float32)])


def sliding(
    config: EnvConfig,
    before: Float[Array, "k 3"],
    pos: Float[Array, "k 3"],
    impulse: Float[Array, " m"],
    snapshot: Snapshot,
) -> tuple[Int[Array, " k"], Float[Array, " k"]]:
    """What bodies sound like that slide, and how loud: the root of the friction's power [W].

    Args:
        config: Options.
        before: Where bodies were [m].
        pos: Where they are [m].
        impulse: Of all contacts in the step before [N s].
        snapshot: After the step.
    """
    agents, count = config.num_agents, pos.shape[0]
    part = slice(agents, agents + count)
    held = jnp.any(snapshot.held[:, None] == jnp.arange(count, dtype=jnp.int32)[None], axis=0)
    on = (impulse[part] > 0) & (snapshot.touch.impulse[part] > 0) & ~held
    speed = jnp.linalg.norm((pos - before)[:, :2], axis=1) / jnp.float32(config.timing.ctrl_dt)
    power = SLIDING * GRAVITY * mass_of(config, snapshot)[part] * jnp.minimum(speed, FASTEST)
    kind = touch_meaning(snapshot.scene, snapshot.touch).own[part, Semantic.MATERIAL]
    return jnp.asarray(stuff_class())[kind], jnp.where(on & (speed > SLOWEST), jnp.sqrt(power), 0.0)


def door_noises(
    config: EnvConfig, before: Float[Array, " h"], snapshot: Snapshot
) -> tuple[Strikes, Int[Array, " h"], Float[Array, " h"]]:
    """Thuds of leaves that have come to where they are shut or wide open; what those sound like that turn, how loud.

    Args:
        config: Options.
        before: How far each was open.
        snapshot: After the step.
    """
    physics, house, angle = snapshot.bank.physics, snapshot.house, snapshot.door_angle
    pos, body = leaves(config, snapshot)
    there = physics.door_valid[house]
    rate = jnp.where(there, jnp.abs(angle - before) / jnp.float32(config.timing.ctrl_dt), 0.0)
    moves, stops = rate > LEAST_TURN, (physics.door_closed[house], physics.door_wide[house])
    came = [(jnp.abs(angle - stop) < AT_STOP) & (jnp.abs(before - stop) >= AT_STOP) for stop in stops]
    frame = config.audio.frame
    thuds = Strikes(
        pos=pos,
        body=body,
        row=jnp.full(rate.shape, STRIKES.index("thud"), jnp.int32),
        gain=jnp.where(moves & (came[0] | came[1]), rate, 0.0),
        start=jnp.full(rate.shape, (snapshot.step + 1) * frame - 1, jnp.int32),
    )
    return thuds, jnp.full(rate.shape, RUBS.index("creak"), jnp.int32), jnp.where(moves, rate, 0.0)
