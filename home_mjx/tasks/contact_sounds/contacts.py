"""Impact and friction sounds from contacts, and sounds of doors from their motion."""

import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.audio_jax.contact_sounds.sound_bank import SUSTAINED, TRANSIENTS
from home_mjx.audio_jax.contact_sounds.sound_slots import TransientSounds
from home_mjx.physics.base.state import FLOOR
from home_mjx.schema.semantic import Semantic
from home_mjx.tasks.base.config import EnvConfig
from home_mjx.tasks.base.snapshot import Snapshot, contact_semantics
from home_mjx.tasks.contact_sounds.footsteps import stuff_classes

GRAVITY = 9.81  # [m/s²]
MIN_IMPULSE = 0.05  # [N s] minimum impulse of an impact sound
MIN_SPEED_CHANGE = 0.15  # [m/s] minimum change of speed in a step for an impact sound
MAX_IMPACT_GAIN = 30.0  # maximum gain of an impact: 30 dB above speech for wood
AGENT_IMPACT_GAIN = 0.05  # gain factor of impacts by agents, whose bodies are soft
MAX_SOURCE_OFFSET = 0.1  # [m] maximum distance of the source from the contact, inside the body
MIN_SLIDING_SPEED = 0.03  # [m/s] minimum speed of a sliding sound, so that jitter is silent
SLIDING_FRICTION = 0.4  # friction coefficient of furniture on its feet
MAX_SLIDING_SPEED = 3.0  # [m/s] maximum speed that counts for the gain of a sliding sound
MIN_LEAF_SPEED = 0.05  # [rad/s], or [m/s] if it slides: minimum speed of a leaf that sounds
MAX_STOP_DISTANCE = 0.02  # [rad], or [m] if it slides: maximum distance from an end stop


def impact_sounds(
    config: EnvConfig,
    impulse: Float[Array, " m"],
    change: Float[Array, " m"],
    snapshot: Snapshot,
) -> TransientSounds:
    """Return one impact per dynamic body; its gain is the contact impulse [N s] beyond the resting one, 0 if none.

    It is also 0 up to an impulse of `MIN_IMPULSE` or a change of speed of `MIN_SPEED_CHANGE`, and at most
    `MAX_IMPACT_GAIN`. The resting impulse is that of the previous step, at least that of its weight. An impact of two
    bodies sounds once, one of two agents not at all. Agents' impacts are softer by `AGENT_IMPACT_GAIN`, and sound as
    the other side's material. Contacts have no time within a step, so impacts begin in the middle of the frame.

    Args:
        config: Options.
        impulse: Contact impulse of each body in the previous step [N s].
        change: Change of each body's speed in this step [m/s].
        snapshot: The environment after the step.
    """
    touch, agents, frame = snapshot.body_contacts, config.num_agents, config.audio.frame
    number = jnp.arange(touch.contact_impulse.shape[0], dtype=jnp.int32)
    resting = carried_masses(config, snapshot) * jnp.float32(GRAVITY * config.timing.ctrl_dt)
    blow = touch.contact_impulse - jnp.maximum(impulse, resting)
    meaning, (middle, body) = contact_semantics(snapshot.scene, touch), body_centers(config, snapshot)
    inwards = middle - touch.contact_pos
    far = jnp.maximum(jnp.linalg.norm(inwards, axis=1), MAX_SOURCE_OFFSET)[:, None]
    is_agent, by_agent = number < agents, (touch.contact_partner >= 0) & (touch.contact_partner < agents)
    told = jnp.where(
        is_agent, touch.contact_partner <= FLOOR, (touch.contact_partner < agents) | (touch.contact_partner > number)
    )
    kind = jnp.where(is_agent, meaning.other[:, Semantic.MATERIAL], meaning.body[:, Semantic.MATERIAL])
    softly = jnp.where(is_agent | by_agent, AGENT_IMPACT_GAIN, 1.0)
    there = told & (blow > MIN_IMPULSE) & (change > MIN_SPEED_CHANGE)
    return TransientSounds(
        pos=touch.contact_pos + inwards * (MAX_SOURCE_OFFSET / far),  # inside the body, which does not occlude it
        body=body,
        row=TRANSIENTS.index("hit_wood") + jnp.asarray(stuff_classes())[kind],
        gain=jnp.where(there, jnp.minimum(softly * blow, MAX_IMPACT_GAIN), 0.0),
        start=jnp.full(number.shape, snapshot.step * frame + frame // 2, jnp.int32),
    )


def body_centers(config: EnvConfig, snapshot: Snapshot) -> tuple[Float[Array, "m 3"], Int[Array, " m"]]:
    """Return centres of the bounding boxes of agents, movable bodies, then doors [m], 0 for padding; and object ids."""
    moving, agents = snapshot.scene.moving, config.num_agents
    box, there = moving.box, (moving.instance >= 0)[:, None]
    pos = jnp.where(there, jnp.mean(jnp.where(there[:, None], box, 0.0), axis=1), 0.0)
    return jnp.roll(pos, agents, axis=0), jnp.roll(moving.object_id, agents)


def carried_masses(config: EnvConfig, snapshot: Snapshot) -> Float[Array, " m"]:
    """Return the masses of agents, movable bodies, then doors [kg] that rest on contacts; 0 for doors, as they hang.

    Those of movable bodies are times the factor sampled for the episode.
    """
    bodies = snapshot.bank.physics.body_mass[snapshot.house]
    if snapshot.body_scale is not None and snapshot.body_scale.mass is not None:
        bodies = bodies * snapshot.body_scale.mass
    agents = jnp.array([body.mass for body in config.agents], jnp.float32)
    return jnp.concatenate([agents, bodies, jnp.zeros(snapshot.door_angle.shape, jnp.float32)])


def sliding_sounds(
    config: EnvConfig,
    before: Float[Array, "k 3"],
    pos: Float[Array, "k 3"],
    impulse: Float[Array, " m"],
    snapshot: Snapshot,
) -> tuple[Int[Array, " k"], Float[Array, " k"]]:
    """Return each movable body's row of `SUSTAINED` and its gain: root of friction power [W]; 0 if held or not sliding.

    `before` and `pos` are positions of bodies before and after the step [m]. `impulse` is the contact impulse of each
    dynamic body in the previous step [N s]. A body slides only with contact in both steps and a horizontal speed above
    `MIN_SLIDING_SPEED`; speeds above `MAX_SLIDING_SPEED` count as that.
    """
    agents, count = config.num_agents, pos.shape[0]
    part = slice(agents, agents + count)
    held = jnp.any(snapshot.held[:, None] == jnp.arange(count, dtype=jnp.int32)[None], axis=0)
    on = (impulse[part] > 0) & (snapshot.body_contacts.contact_impulse[part] > 0) & ~held
    speed = jnp.linalg.norm((pos - before)[:, :2], axis=1) / jnp.float32(config.timing.ctrl_dt)
    power = SLIDING_FRICTION * GRAVITY * carried_masses(config, snapshot)[part] * jnp.minimum(speed, MAX_SLIDING_SPEED)
    kind = contact_semantics(snapshot.scene, snapshot.body_contacts).body[part, Semantic.MATERIAL]
    return jnp.asarray(stuff_classes())[kind], jnp.where(on & (speed > MIN_SLIDING_SPEED), jnp.sqrt(power), 0.0)


def door_sounds(
    config: EnvConfig, before: Float[Array, " h"], snapshot: Snapshot
) -> tuple[TransientSounds, Int[Array, " h"], Float[Array, " h"]]:
    """Return impacts of leaves that reach an end stop (gain: speed, else 0); each leaf's row of `SUSTAINED`, its gain.

    The gain of a moving leaf is its speed [rad/s], or [m/s] if it slides; 0 up to `MIN_LEAF_SPEED`. To reach a stop is
    to come closer than `MAX_STOP_DISTANCE` to its closed or wide open position in this step. `before` is
    `Snapshot.door_angle` before the step.
    """
    physics, house, angle = snapshot.bank.physics, snapshot.house, snapshot.door_angle
    pos, body = (x[x.shape[0] - angle.shape[0] :] for x in body_centers(config, snapshot))  # leaves come last
    there = physics.door_valid[house]
    rate = jnp.where(there, jnp.abs(angle - before) / jnp.float32(config.timing.ctrl_dt), 0.0)
    moves, stops = rate > MIN_LEAF_SPEED, (physics.door_closed[house], physics.door_fully_open[house])
    came = [
        (jnp.abs(angle - stop) < MAX_STOP_DISTANCE) & (jnp.abs(before - stop) >= MAX_STOP_DISTANCE) for stop in stops
    ]
    frame = config.audio.frame
    thuds = TransientSounds(
        pos=pos,
        body=body,
        row=jnp.full(rate.shape, TRANSIENTS.index("thud"), jnp.int32),
        gain=jnp.where(moves & (came[0] | came[1]), rate, 0.0),
        start=jnp.full(rate.shape, (snapshot.step + 1) * frame - 1, jnp.int32),
    )
    return thuds, jnp.full(rate.shape, SUSTAINED.index("creak"), jnp.int32), jnp.where(moves, rate, 0.0)
