"""Present sound sources of an environment, and the motion of those without a body along a distance field."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int, UInt16

from home_mjx.audio_jax.auralization.clips import CLIPS
from home_mjx.audio_jax.base.endpoints import SoundSources
from home_mjx.bank.bank import HouseBank
from home_mjx.navigation.grid import cell_at_feet, cell_number, is_home_cell, row_of_cell
from home_mjx.navigation.spawn import random_source
from home_mjx.schema.compiled import FIELD_UNREACHABLE
from home_mjx.tasks.base.config import EnvConfig
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.sounds.sound_events import NUM_SOUNDS, SoundEvents

NO_BODY, SILENT = -1, -1
NUM_SUBSTEPS = 4  # number of parts of a move; each one ends at the next cell at the latest


def house_source(
    config: EnvConfig, bank: HouseBank, house: Int[Array, ""], key: Array, clip: Int[Array, ""] | None = None
) -> SoundSources:
    """Return sources of a house: the first at a random start point, with an endless clip; the others are silent.

    It is `config.source_height` above the floor; `clip` is an index into `CLIPS`, None: `config.clip`.
    """
    number = config.num_sources + config.num_switch_sources
    pos = random_source(bank, house, config.source_height, key)
    return SoundSources(
        pos=jnp.broadcast_to(pos, (number, 3)),
        body=jnp.full(number, NO_BODY, jnp.int32),
        clip=jnp.full(number, SILENT, jnp.int32).at[0].set(CLIPS.index(config.clip) if clip is None else clip),
        gain=jnp.ones(number, jnp.float32),
        period=jnp.full(number, jnp.inf, jnp.float32),
        duration=jnp.full(number, jnp.inf, jnp.float32),
    )


def row_sources(
    snapshot: Snapshot,
    emission: SoundEvents,
    point: Float[Array, "d 3"],
    body: Int[Array, " d"],
    field: UInt16[Array, "cell f"],
    column: Int[Array, " d"],
) -> SoundSources:
    """Return the present sources of a row's sounds; for a row without sounds, the previous sources.

    Sounds beyond the number of sources are dropped. One without a finite position is silent, at its previous place.

    Args:
        snapshot: The environment; at step 0 no source has moved yet.
        emission: Sounds of the row.
        point: Sound position of each descriptor [m]; inf if it has none.
        body: Object id of each descriptor's target; -1 if none.
        field: Distance fields of the task bank.
        column: Column of each descriptor's field; -1 if none.
    """
    before = snapshot.sounds
    count = min(snapshot.config.num_sources, NUM_SOUNDS)
    rows = jax.tree.map(lambda x: x[:count], emission)
    of = jnp.maximum(rows.emitter, 0).astype(jnp.int32)
    pos, own = point[of], body[of]
    way = jnp.where(snapshot.step == 0, 0.0, rows.speed * jnp.float32(snapshot.config.timing.ctrl_dt))
    goal = column[jnp.maximum(rows.destination, 0)].astype(jnp.int32)
    walks = (way > 0) & (rows.destination >= 0) & (goal >= 0)
    bank, house, height = snapshot.bank, snapshot.house, jnp.float32(snapshot.config.source_height)
    gone = jax.vmap(lambda p, w, g: move_along_field(bank, house, field, jnp.maximum(g, 0), p, w, height))(
        pos, way, goal
    )
    pos = jnp.where(walks[:, None], gone, pos)
    known = (rows.emitter >= 0) & jnp.all(jnp.isfinite(pos), axis=-1)
    new = before.replace(
        pos=before.pos.at[:count].set(jnp.where(known[:, None], pos, before.pos[:count])),
        body=before.body.at[:count].set(own),
        clip=jnp.full_like(before.clip, SILENT).at[:count].set(jnp.where(known, rows.clip.astype(jnp.int32), SILENT)),
        gain=before.gain.at[:count].set(rows.gain),
        period=before.period.at[:count].set(rows.period),
        duration=before.duration.at[:count].set(rows.duration),
    )
    has_any = jnp.any(emission.emitter >= 0)
    return jax.tree.map(lambda a, b: jnp.where(has_any, a, b), new, before)


def move_along_field(
    bank: HouseBank,
    house: Int[Array, ""],
    field: UInt16[Array, "cell f"],
    goal: Int[Array, ""],
    pos: Float[Array, "3"],
    max_length: Float[Array, ""],
    height: Float[Array, ""],
) -> Float[Array, "3"]:
    """Return the position of a point above the floor after a move from cell to cell down a field.

    It stays without a home cell around it.

    Args:
        bank: The houses.
        house: Index of the house.
        field: Distances of all cells to goals, stored as in `NavigationArrays.field`.
        goal: Column of the field.
        pos: Position before the move [m].
        max_length: Maximum length of the move [m]; the part of it beyond `NUM_SUBSTEPS` cells is dropped.
        height: Height of the point above the floor [m].
    """
    navigation = bank.navigation
    around = jnp.array([(0, dy, dx) for dy in (-1, 0, 1) for dx in (-1, 0, 1)], jnp.int32)
    limits = jnp.array(navigation.cell.shape[1:], jnp.int32) - 1
    for _ in range(NUM_SUBSTEPS):
        at = cell_at_feet(bank, house, pos.at[2].add(-height))
        near = jnp.clip(at + around, 0, limits)
        cell = cell_number(bank, house, near)
        home = is_home_cell(bank, house, cell)
        row = row_of_cell(cell)
        best = jnp.argmin(jnp.where(home, field[row, goal].astype(jnp.int32), FIELD_UNREACHABLE + 1))
        plan = (near[best, :0:-1].astype(jnp.float32) + 0.5) * jnp.float32(bank.spec.cell) + navigation.origin[house]
        aim = jnp.append(plan, navigation.height[row[best]] + height)
        aim = jnp.where(jnp.any(home), aim, pos)
        length = jnp.linalg.norm(aim - pos)
        pos = pos + (aim - pos) * jnp.minimum(1.0, max_length / NUM_SUBSTEPS / jnp.maximum(length, 1e-6))
    return pos
