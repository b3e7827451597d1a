"""Lines of overlays that change with each step: contacts with their forces, sound paths, portals and lamps."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, UInt8

from home_mjx.audio_jax.base.endpoints import Listener, SoundSource
from home_mjx.audio_jax.propagation.early import select_producers
from home_mjx.core.transforms import camera_quat
from home_mjx.navigation import passable_portals
from home_mjx.raycast_render.casting.cast import cast
from home_mjx.raycast_render.lighting.lights import place_lights
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.base.state import EnvParams, State
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.sensors.cameras import agent_ids, eye_position
from home_mjx.tasks.sensors.hearing import all_sources

METRES_PER_NEWTON, MAX_BAR = 1 / 500, 1.0  # length of a contact's bar, and the longest one [m]
MIN_BAR = 0.05  # [m]
MIN_LEVEL = -60.0  # [dB] re the source at 1 m; quieter paths are not drawn
PORTAL_HEIGHT = 2.0  # [m], of the bar in a portal
OPEN_COLOUR, CLOSED_COLOUR = (60, 200, 110), (235, 60, 60)
LAMP_REACH = 0.15  # [m], from a lamp to the ends of its cross
LIT_COLOUR, DARK_COLOUR = (255, 220, 60), (110, 110, 110)
SECOND_LEG_ORDER = 1  # order of reflection up to which a path has one bend, so that its legs are known

Lines = tuple[Float[np.ndarray, "n 2 3"], UInt8[np.ndarray, "n 2 3"]]  # ends [m] and colours


class LiveLines:
    """Lines of the first agent's environment, as ends and colours.

    Args:
        env: The environment.
    """

    def __init__(self, env: Env[HouseholdEnv]) -> None:
        self._env = env
        self._contacts = jax.jit(lambda params, state: env.core.snapshot(params, state).body_contacts)
        self._portals, self._lamps = jax.jit(self._find_portals), jax.jit(self._find_lamps)
        self._paths = jax.jit(lambda params, state: trace_bends(env, env.core.snapshot(params, state)))

    def contacts(self, state: Any) -> Lines:
        """Return a vertical bar at each body's strongest contact, as long as the force on the body is large."""
        found = self._contacts(self._env.params, state)
        impulse, place = np.asarray(found.contact_impulse), np.asarray(found.contact_pos)
        place, force = place[impulse > 0], impulse[impulse > 0] / self._env.dt
        top = place + np.clip(force * METRES_PER_NEWTON, MIN_BAR, MAX_BAR)[:, None] * np.array([0.0, 0.0, 1.0])
        return np.stack([place, top], axis=1), np.full((len(place), 2, 3), (235, 60, 60), np.uint8)

    def portals(self, state: State) -> Lines:
        """Return an upright bar in each portal between rooms: green if agents can pass now, red if not."""
        place, is_open = (np.asarray(x) for x in self._portals(self._env.params, state))
        house = int(state.world.house)
        known = np.asarray(self._env.bank.navigation.portal_kind[house]) >= 0
        colours = np.where(is_open[known][:, None, None], OPEN_COLOUR, CLOSED_COLOUR).astype(np.uint8)
        top = place[known] + np.array([0.0, 0.0, PORTAL_HEIGHT])
        return np.stack([place[known], top], axis=1), np.broadcast_to(colours, (len(colours), 2, 3))

    def lamps(self, state: State) -> Lines:
        """Return a cross at each light of a lamp: yellow if it is on, grey if off."""
        place, power = (np.asarray(x) for x in self._lamps(self._env.params, state))
        house, lights = int(state.world.house), self._env.bank.lights
        known = np.asarray((lights.instance[house] >= 0) & ~lights.daylight[house])
        ends = LAMP_REACH * np.stack([-np.eye(3), np.eye(3)], axis=1)
        lines = (place[known][:, None, None] + ends).reshape(-1, 2, 3)
        colours = np.where(power[known][:, None] > 0, LIT_COLOUR, DARK_COLOUR).astype(np.uint8)
        return lines, np.broadcast_to(np.repeat(colours, 3, axis=0)[:, None], (len(lines), 2, 3))

    def _find_portals(self, params: EnvParams, state: State) -> tuple[Array, Array]:
        """Return place and passability of all portals; to be jitted."""
        snapshot = self._env.core.snapshot(params, state)
        portal_pos = params.bank.navigation.portal_pos[snapshot.house]
        return portal_pos, passable_portals(params.bank, snapshot.house, snapshot.door_angle)

    def _find_lamps(self, params: EnvParams, state: State) -> tuple[Array, Array]:
        """Return place and luminous power of all lights; to be jitted."""
        placed = place_lights(self._env.core.snapshot(params, state).scene, 1.0)
        return jnp.stack([placed.pos.x, placed.pos.y, placed.pos.z], axis=-1), placed.power

    def sound_paths(self, state: Any) -> Lines:
        """Return the legs of all audible paths from sources to the agent's head, louder ones brighter."""
        ears, bend, end, level = (np.asarray(x) for x in self._paths(self._env.params, state))
        is_heard = level > MIN_LEVEL
        bend, end, level = bend[is_heard], end[is_heard], level[is_heard]
        first = np.stack([np.broadcast_to(ears, bend.shape), bend], axis=1)
        lines = np.concatenate([first, np.stack([bend, end], axis=1)])
        bright = np.clip(1 - np.tile(level, 2) / MIN_LEVEL, 0.15, 1.0)[:, None, None]
        colours = (bright * np.array([255.0, 220.0, 60.0])).astype(np.uint8)
        return lines, np.broadcast_to(colours, (len(lines), 2, 3))


def trace_bends(
    env: Env[HouseholdEnv], snapshot: Snapshot
) -> tuple[Float[Array, "3"], Float[Array, "n 3"], Float[Array, "n 3"], Float[Array, " n"]]:
    """Return the first agent's ears, each path's bend next to them, the end of its next leg, and its level [dB] (JAX).

    A path that bends once, such as a first-order reflection, comes from the point where the lengths of its two legs
    add up to its own, and ends at the source. Of others only the leg to the ears is known: the bend is where the
    direction of incidence meets a surface, and the next leg has no length.
    """
    config, pose = env.core.config, snapshot.pose
    ears, own = eye_position(config, pose)[0], agent_ids(snapshot.bank, config.num_agents)[0]
    listener = Listener(ears, camera_quat(pose.yaw[0], pose.pitch[0]), own, snapshot.head)
    audible = snapshot.sounds.clip >= 0

    def of_source(source: SoundSource) -> tuple[Array, ...]:
        """Return bends, ends and levels of one source."""
        parts = [
            _bends(snapshot, source, ears, own, find(snapshot.scene, source, listener, config.audio), number)
            for number, find in enumerate(select_producers(config.audio))
        ]
        return tuple(jnp.concatenate(x) for x in zip(*parts, strict=True))

    count = snapshot.sounds.pos.shape[0]
    sources = jax.tree.map(lambda x: x[:count], all_sources(snapshot))
    bend, end, level = jax.vmap(of_source)(sources)
    level = jnp.where(audible[:, None], level, -jnp.inf)
    return ears, bend.reshape(-1, 3), end.reshape(-1, 3), level.reshape(-1)


def _bends(
    snapshot: Snapshot, source: SoundSource, ears: Array, own: Array, paths: Any, producer: int
) -> tuple[Array, Array, Array]:
    """Return bends, ends and levels of one producer's paths; the first producer's are direct or bend at one edge."""
    energy = jnp.mean(jnp.square(paths.gain), axis=-1)
    level = 10 * jnp.log10(jnp.maximum(energy, 1e-12))
    away = source.pos - ears
    along = (paths.distance**2 - jnp.sum(away**2)) / (
        2 * jnp.maximum(paths.distance - jnp.sum(paths.direction * away, axis=-1), 1e-3)
    )
    bends_once = producer == 0 or snapshot.config.audio.early.reflection_order == SECOND_LEG_ORDER
    if not bends_once:
        along = cast(snapshot.scene, jnp.broadcast_to(ears, paths.direction.shape), paths.direction, exclude=own).t
    bend = ears + jnp.minimum(along, paths.distance)[:, None] * paths.direction
    return bend, jnp.broadcast_to(source.pos, bend.shape) if bends_once else bend, level
