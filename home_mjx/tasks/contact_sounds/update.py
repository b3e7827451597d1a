"""Contact sounds after a control step."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from home_mjx import physics
from home_mjx.audio_jax.contact_sounds.sound_slots import (
    ContactSounds,
    SustainedSounds,
    TransientSounds,
    add_transients,
    update_sustained,
)
from home_mjx.physics import PhysicsState
from home_mjx.tasks.base.config import EnvConfig
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.contact_sounds.contacts import body_centers, door_sounds, impact_sounds, sliding_sounds
from home_mjx.tasks.contact_sounds.footsteps import footsteps


def update_contact_sounds(
    config: EnvConfig, template: physics.Template, before: PhysicsState, after: PhysicsState, snapshot: Snapshot
) -> tuple[ContactSounds, Bool[Array, ""]]:
    """Return the contact sounds after one control step, and whether any was lost, see `Status.NOISES`.

    Lost are sounds that found no slot, and all but the last of several footsteps of an agent. `before` and `after` are
    physics states of that step. `snapshot` is of after it, with the contact sounds from before it.
    """
    options, noises, audio = config.contact_sounds, snapshot.contact_sounds, config.audio
    assert options is not None
    assert noises is not None
    strikes: list[TransientSounds] = []
    walked, lost = noises.walked_distance, jnp.zeros((), bool)
    if options.footsteps:
        steps, walked, lost = footsteps(config, physics.agent_pose(template, before)[0], snapshot, noises)
        strikes.append(steps)
    if options.impacts:
        strikes.append(impact_sounds(config, before.contact_impulse, _speed_changes(template, before, after), snapshot))
    rubs, thuds = _friction_sounds(config, template, before, after, snapshot)
    new = jax.tree.map(lambda *x: jnp.concatenate(x), *strikes, *thuds) if strikes or thuds else None
    kept, full = noises.transients, jnp.zeros((), bool)
    if new is not None:
        kept, full = add_transients(kept, new, audio, snapshot.step * audio.frame)
    return ContactSounds(transients=kept, sustained=rubs[0], walked_distance=walked), lost | full | rubs[1]


def _friction_sounds(
    config: EnvConfig, template: physics.Template, before: PhysicsState, after: PhysicsState, snapshot: Snapshot
) -> tuple[tuple[SustainedSounds, Bool[Array, ""]], list[TransientSounds]]:
    """Return (friction sounds of bodies, then doors; whether one found no slot) and the impacts of door leaves."""
    options, noises, count = config.contact_sounds, snapshot.contact_sounds, snapshot.bank.spec.num_bodies
    assert options is not None
    assert noises is not None
    parts: list[tuple[Array, ...]] = []  # positions, object ids, kinds of sound, gains
    thuds: list[TransientSounds] = []
    if options.scrapes:
        earlier, pos = (physics.body_pose(template, state)[0] for state in (before, after))
        body = body_centers(config, snapshot)[1][config.num_agents : config.num_agents + count]
        parts.append((pos, body, *sliding_sounds(config, earlier, pos, before.contact_impulse, snapshot)))
    if options.doors:
        heard, row, gain = door_sounds(config, physics.door_angle(template, before), snapshot)
        parts.append((heard.pos, heard.body, row, gain))
        thuds.append(heard)
    if not sum(gain.size for *_, gain in parts):  # a house may have no dynamic bodies
        return (noises.sustained, jnp.zeros((), bool)), thuds
    return update_sustained(noises.sustained, *(jnp.concatenate(x) for x in zip(*parts, strict=True))), thuds


def _speed_changes(template: physics.Template, before: PhysicsState, after: PhysicsState) -> Float[Array, " m"]:
    """Return the length of each agent's, body's, then door's change of velocity [m/s]; [rad/s] for leaves that turn."""
    layout, change = template.layout, after.qvel - before.qvel
    agents = change[layout.agent_qpos].reshape(-1, 4)[:, :3]
    bodies = change[layout.body_qvel].reshape(-1, 6)[:, :3]
    doors = change[layout.door_qvel][:, None]
    return jnp.concatenate([jnp.linalg.norm(part, axis=1) for part in (agents, bodies, doors)])
