"""Footsteps of agents: one at every step's length, on what is under the foot."""

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from home_mjx.audio_jax.contact_sounds.slots import Noises, Strikes
from home_mjx.audio_jax.contact_sounds.synthesis import FLOOR_KINDS, FLOORS, STUFF_KINDS, STUFFS, VARIANTS
from home_mjx.raycast_render.casting.cast import cast
from home_mjx.raycast_render.scene.surface import semantics
from home_mjx.schema.compiled import Ray
from home_mjx.schema.material_kinds import MATERIAL_KINDS
from home_mjx.schema.semantic import Semantic
from home_mjx.tasks.base.config import EnvConfig
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.sensors.cameras import agent_ids

REACH = 3.0  # [m] under the middle of an agent
ABOVE = 0.05  # [m] over the floor is a foot, so that the floor does not hide it
FASTEST = 4.0  # [m/s]: no step is louder than at this speed


def floor_class() -> np.ndarray:
    """Index into FLOORS of each kind of material; the last for an unknown one, which is soft."""
    return _classes(FLOORS, FLOOR_KINDS, "soft")


def stuff_class() -> np.ndarray:
    """Index into STUFFS of each kind of material; the last for an unknown one, which is wooden."""
    return _classes(STUFFS, STUFF_KINDS, "wood")


def _classes(classes: dict, kinds: dict[str, tuple[str, ...]], other: str) -> np.ndarray:
    names = list(classes)
    of_kind = {kind: names.index(name) for name, members in kinds.items() for kind in members}
    return np.array([of_kind.get(kind, names.index(other)) for kind in (*MATERIAL_KINDS, "")], np.int32)


def step_length(config: EnvConfig, snapshot: Snapshot) -> Float[Array, ""]:
    """From one footstep to the next [m], as this episode has drawn it."""
    assert config.noises is not None
    drawn = None if snapshot.drawn is None else snapshot.drawn.step_length
    return jnp.float32(config.noises.step_length) if drawn is None else drawn


def footsteps(
    config: EnvConfig, before: Float[Array, "a 3"], snapshot: Snapshot, noises: Noises
) -> tuple[Strikes, Float[Array, " a"], Bool[Array, ""]]:
    """Of one control step; those without gain are none.

    Args:
        config: Options.
        before: Where agents were [m].
        snapshot: After the step.
        noises: Before it.

    Returns:
        The steps, how far each agent has walked since the start of the episode [m], and whether one took several, of
        which only the last is heard.
    """
    length, frame = step_length(config, snapshot), config.audio.frame
    pos = snapshot.pose.pos
    way = jnp.linalg.norm((pos - before)[:, :2], axis=1)
    walked = noises.walked + way
    count, earlier = jnp.floor(walked / length), jnp.floor(noises.walked / length)
    share = jnp.clip((count * length - noises.walked) / jnp.maximum(way, 1e-9), 0.0, 1.0)
    middle = before + share[:, None] * (pos - before)
    down = jnp.broadcast_to(jnp.array([0.0, 0.0, -1.0], jnp.float32), pos.shape)
    own = agent_ids(snapshot.bank, pos.shape[0])
    hit = cast(snapshot.scene, middle, down, t_max=REACH, exclude=own, mask=int(Ray.SOUND))
    kind = jnp.asarray(floor_class())[semantics(snapshot.scene, hit, Semantic.MATERIAL)]
    speed = jnp.minimum(way / jnp.float32(config.timing.ctrl_dt), FASTEST)
    steps = Strikes(
        pos=middle.at[:, 2].add(jnp.where(hit.instance < 0, 0.0, ABOVE - hit.t)),
        body=own,
        row=kind * VARIANTS + count.astype(jnp.int32) % VARIANTS,
        gain=jnp.where((count > earlier) & (hit.instance >= 0), speed, 0.0),
        start=snapshot.step * frame + (share * frame).astype(jnp.int32),
    )
    return steps, walked, jnp.any(count > earlier + 1)
