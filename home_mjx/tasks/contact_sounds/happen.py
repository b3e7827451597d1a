"""Contact sounds after a control step."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from home_mjx import physics
from home_mjx.audio_jax.contact_sounds.slots import Noises, Rubs, Strikes, with_rubs, with_strikes
from home_mjx.physics import PhysicsState
from home_mjx.tasks.base.config import EnvConfig
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.contact_sounds.contacts import blows, door_noises, middles, sliding
from home_mjx.tasks.contact_sounds.steps import footsteps


def after_step(
    config: EnvConfig, template: physics.Template, before: PhysicsState, after: PhysicsState, snapshot: Snapshot
) -> tuple[Noises, Bool[Array, ""]]:
    """Return the contact sounds after one control step, and whether any found no slot, see `Status.NOISES`.

    Args:
        config: Options, with `noises`.
        template: Model of the physics.
        before: Physics state before the step.
        after: Physics state after the step.
        snapshot: The environment after the step, with the contact sounds from before it.
    """
    options, noises, audio = config.noises, snapshot.noises, config.audio
    assert options is not None
    assert noises is not None
    strikes: list[Strikes] = []
    walked, lost = noises.walked, jnp.zeros((), bool)
    if options.footsteps:
        steps, walked, lost = footsteps(config, physics.agent_pose(template, before)[0], snapshot, noises)
        strikes.append(steps)
    if options.impacts:
        strikes.append(blows(config, before.impulse, _change(template, before, after), snapshot))
    rubs, thuds = _rubs(config, template, before, after, snapshot)
    new = jax.tree.map(lambda *x: jnp.concatenate(x), *strikes, *thuds) if strikes or thuds else None
    kept, full = noises.strikes, jnp.zeros((), bool)
    if new is not None:
        kept, full = with_strikes(kept, new, audio, snapshot.step * audio.frame)
    return Noises(strikes=kept, rubs=rubs[0], walked=walked), lost | full | rubs[1]


def _rubs(
    config: EnvConfig, template: physics.Template, before: PhysicsState, after: PhysicsState, snapshot: Snapshot
) -> tuple[tuple[Rubs, Bool[Array, ""]], list[Strikes]]:
    """Return friction sounds of bodies and doors, in this order, and impacts of door leaves."""
    options, noises, count = config.noises, snapshot.noises, snapshot.bank.spec.num_bodies
    assert options is not None
    assert noises is not None
    parts: list[tuple[Array, ...]] = []  # positions, object ids, kinds of sound, gains
    thuds: list[Strikes] = []
    if options.scrapes:
        earlier, pos = (physics.body_pose(template, state)[0] for state in (before, after))
        body = middles(config, snapshot)[1][config.num_agents : config.num_agents + count]
        parts.append((pos, body, *sliding(config, earlier, pos, before.impulse, snapshot)))
    if options.doors:
        heard, row, gain = door_noises(config, physics.door_angle(template, before), snapshot)
        parts.append((heard.pos, heard.body, row, gain))
        thuds.append(heard)
    if not sum(gain.size for *_, gain in parts):  # a house may have no dynamic bodies
        return (noises.rubs, jnp.zeros((), bool)), thuds
    return with_rubs(noises.rubs, *(jnp.concatenate(x) for x in zip(*parts, strict=True))), thuds


def _change(template: physics.Template, before: PhysicsState, after: PhysicsState) -> Float[Array, " m"]:
    """Return the change of each dynamic body's speed [m/s]; [rad/s] for leaves that turn."""
    layout, change = template.layout, after.qvel - before.qvel
    agents = change[layout.agent_qpos].reshape(-1, 4)[:, :3]
    bodies = change[layout.body_qvel].reshape(-1, 6)[:, :3]
    doors = change[layout.door_qvel][:, None]
    return jnp.concatenate([jnp.linalg.norm(part, axis=1) for part in (agents, bodies, doors)])
