"""Start of an episode, and the snapshot of an environment at one instant."""

import functools
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx import physics
from home_mjx.audio_jax.contact_sounds.sound_slots import empty_contact_sounds
from home_mjx.bank.bank import HouseBank
from home_mjx.bank.records import BankSpec
from home_mjx.core.transforms import yaw_quat
from home_mjx.errors import ConfigError
from home_mjx.navigation.compartments import store_bodies
from home_mjx.navigation.doors import door_angles
from home_mjx.navigation.spawn import random_arrangement, random_yaw, sample_starts
from home_mjx.physics import PhysicsState
from home_mjx.raycast_render.scene.scene import agent_sizes, make_scene
from home_mjx.raycast_render.shaders.base import prepare_shaders
from home_mjx.tasks.base.config import EnvConfig
from home_mjx.tasks.base.snapshot import AgentPose, BodyContacts, Snapshot
from home_mjx.tasks.base.state import (
    ARRANGEMENT_TAG,
    DOORS_TAG,
    STORE_TAG,
    SWITCH_TAG,
    VARIATION_TAG,
    EnvParams,
    Episodes,
    World,
    fold_key,
    split_key,
    to_raw_key,
)
from home_mjx.tasks.base.status import status_flags
from home_mjx.tasks.env.actions import NO_TOKEN, action_names
from home_mjx.tasks.env.checks import check_arrangements
from home_mjx.tasks.rules.task_bank import TaskBank
from home_mjx.tasks.sounds.sources import house_source
from home_mjx.tasks.switches.lights import switch_lights
from home_mjx.tasks.switches.states import sample_switches
from home_mjx.tasks.variation.sample import VariationSample, sample_variation

Index = Int[Array, ""] | int | None


def init_physics_and_world(
    config: EnvConfig, memory: dict[str, Any], params: EnvParams, key: Array, house: Index, episode: Index
) -> tuple[PhysicsState, World, Episodes | None, Array]:
    """Return physics state and world at the start of an episode; `house` and `episode` are as for `HouseholdEnv.reset`.

    A row gives the start of the first agent only. `memory` has the sensor states before their first update, by sensor
    name.

    Returns:
        The physics state; the world, with the house's own sounds; the episode's row, None without `params.tasks`; the
        task's key.

    Raises:
        ConfigError: `house` is given although `params.tasks` has rows, or `episode` although it has none.
    """
    bank, agents = params.bank, config.num_agents
    keep, chance, start_key, yaw_key, goal_key, source_key = split_key(to_raw_key(key), 6)
    number, row = _pick_row(params.tasks, episode, chance)
    if row is not None:
        if house is not None:
            hint = "Give `episode`, the number of a row, or an environment without rows: env.with_tasks(None)."
            raise ConfigError("`house` cannot be chosen, because the rows of `tasks` have their own houses", hint=hint)
        house = row.house
    elif house is None:
        house = bank.reset_houses[jax.random.randint(chance, (), 0, bank.num_houses)]
    house = bank.clip_house_index(jnp.asarray(house, jnp.int32))
    drawn = sample_variation(params.variation, fold_key(to_raw_key(key), VARIATION_TAG), bank.lights.ambient.shape[1])
    _, pos = sample_starts(bank, house, agents, 4 * config.body.radius, start_key)
    yaw = random_yaw(yaw_key, (agents,))
    if row is not None:
        pos, yaw = pos.at[0].set(row.start), yaw.at[0].set(row.yaw)
    world = World(
        key=to_raw_key(keep),
        house=house,
        house_fingerprint=bank.fingerprint(house),
        episode=number,
        step=jnp.zeros((), jnp.int32),
        pitch=jnp.zeros(agents, jnp.float32),
        stopped=jnp.zeros(agents, bool),
        spoken_token=jnp.full(agents, NO_TOKEN, jnp.int32),
        sounds=house_source(config, bank, house, source_key, None if drawn is None else drawn.clip),
        action=jnp.zeros((agents, len(action_names(config))), jnp.float32),
        reward=jnp.zeros(agents, jnp.float32),
        sensor_states=memory,
        num_faults=jnp.zeros((), jnp.int32),
        variation=drawn,
        prepared=prepare_light(config, bank, house, drawn),
        switch_on=sample_switches(config, bank, house, fold_key(to_raw_key(key), SWITCH_TAG)),
        contact_sounds=None
        if config.contact_sounds is None
        else empty_contact_sounds(config.contact_sounds, config.audio, agents),
    )
    angle = door_angles(bank, house, config.doors, fold_key(to_raw_key(key), DOORS_TAG), config.fronts)
    arrangement = _pick_arrangement(config, bank, house, pos, world.source, fold_key(to_raw_key(key), ARRANGEMENT_TAG))
    scale = None if drawn is None else drawn.body_scale
    template = physics_template(config, bank.spec)
    data = physics.reset(template, bank, house, pos, yaw, angle, arrangement, scale)
    if config.stored_bodies:
        data = _store(config, bank, house, data, fold_key(to_raw_key(key), STORE_TAG))
    return data, world, row, goal_key


def _store(config: EnvConfig, bank: HouseBank, house: Int[Array, ""], data: PhysicsState, key: Array) -> PhysicsState:
    """Return the state with random bodies in compartments.

    Raises:
        ConfigError: No house of the bank has compartments, or none has movable bodies.
    """
    if bank.compartments.is_empty:
        hint = "Give max_fronts=24, and houses whose furniture has joints."
        raise ConfigError("`stored_bodies` needs compartments, and no house has any", hint=hint)
    if not bank.spec.num_bodies:
        raise ConfigError("`stored_bodies` needs movable bodies, and the bank has none", hint="Raise `max_bodies`.")
    template = physics_template(config, bank.spec)
    angle, poses = physics.door_angle(template, data), physics.body_pose(template, data)
    pos, quat = store_bodies(bank, house, angle, poses, config.stored_bodies, key)
    return _set_poses(template, data, pos, quat)


def _set_poses(
    template: physics.Template, data: PhysicsState, pos: Float[Array, "k 3"], quat: Float[Array, "k 4"]
) -> PhysicsState:
    """Return the state with all movable bodies at these positions [m] and orientations (wxyz)."""
    rows = jnp.concatenate([pos, quat], axis=-1).reshape(-1)
    return data.replace(qpos=data.qpos.at[template.layout.body_qpos].set(rows))


def put_bodies(
    config: EnvConfig, bank: HouseBank, data: PhysicsState, poses: tuple[Array, Array, Array] | None
) -> PhysicsState:
    """Return the state with the movable bodies of `Task.start_bodies` at their poses; None: as it is."""
    if poses is None:
        return data
    template, (mask, pos, quat) = physics_template(config, bank.spec), poses
    now = physics.body_pose(template, data)
    pos, quat = (jnp.where(mask[:, None], a, b) for a, b in zip((pos, quat), now, strict=True))
    return _set_poses(template, data, pos, quat)


def prepare_light(
    config: EnvConfig, bank: HouseBank, house: Int[Array, ""], drawn: VariationSample | None
) -> dict[str, Any] | None:
    """Return what the shaders of an environment's cameras compute once per episode; None if nothing.

    Light that hands can switch is mixed in every image instead.
    """
    if config.switches is not None:
        return None
    return prepare_shaders(config.shaders, bank, house, None if drawn is None else drawn.appearance)


def build_snapshot(config: EnvConfig, params: EnvParams, data: PhysicsState, world: World) -> Snapshot:
    """Build the snapshot of all agents from the physics state `data` and the `world` of the same instant."""
    template, drawn = physics_template(config, params.bank.spec), world.variation
    pos, yaw = physics.agent_pose(template, data)
    bodies, turned = physics.body_pose(template, data), jax.vmap(yaw_quat)(yaw)
    sizes, angle = agent_sizes(config.agents), physics.door_angle(template, data)
    look = None if drawn is None else drawn.appearance
    if world.switch_on is not None:
        look = switch_lights(params.bank, params.bank.clip_house_index(world.house), world.switch_on, look)
    return Snapshot(
        step=world.step,
        key=world.key,
        pose=AgentPose(pos=pos, yaw=yaw, pitch=world.pitch),
        velocity=physics.agent_velocity(template, data),
        stopped=world.stopped,
        spoken_token=world.spoken_token,
        in_contact=physics.agent_contact(template, data),
        held=data.held,
        door_angle=angle,
        body_contacts=BodyContacts(
            contact_impulse=data.contact_impulse,
            contact_pos=data.contact_pos,
            contact_partner=data.contact_partner,
        ),
        sounds=world.sounds,
        action=world.action,
        reward=world.reward,
        tasks=params.tasks,
        config=config,
        scene=make_scene(params.bank, world.house, *bodies, pos, turned, config.backend, angle, sizes, look).replace(
            prepared=world.prepared
        ),
        variation=drawn,
        switch_on=world.switch_on,
        contact_sounds=world.contact_sounds,
        head=params.head,
    )


def physics_template(config: EnvConfig, spec: BankSpec) -> physics.Template:
    """Return the physics template for banks of a capacity, made once and cached."""
    return _cached_template(config.physics_setup, spec)


@functools.lru_cache(maxsize=32)
def _cached_template(config: physics.PhysicsSetup, spec: BankSpec) -> physics.Template:
    # Built once per capacity; inside a trace it must hold no tracers.
    """Return the physics template of one setup and capacity; equal arguments return the same object."""
    with jax.ensure_compile_time_eval():
        return physics.Template(config, spec)


def weights_flag(tasks: Episodes | TaskBank | None, episode: Index) -> Int[Array, ""]:
    """Return the flag `WEIGHTS` if a reset samples rows by weights of which none is positive and finite; else 0."""
    if isinstance(tasks, TaskBank) and tasks.weights is not None and episode is None:
        return status_flags(WEIGHTS=~tasks.has_weight())
    return jnp.zeros((), jnp.int32)


def is_sequential(tasks: Episodes | TaskBank | None) -> bool:
    """Return whether batches take the rows of `tasks` in order; False without rows, or with weights to sample by."""
    return tasks is not None and not (isinstance(tasks, TaskBank) and tasks.weights is not None)


def _pick_row(tasks: Episodes | TaskBank | None, episode: Index, key: Array) -> tuple[Int[Array, ""], Episodes | None]:
    """Return the number of an episode, as given or sampled, and the row at that number modulo the number of rows.

    A `TaskBank` is sampled by its weights, `Episodes` uniformly. Without `tasks` they are -1 and None; `ConfigError` if
    a number is given then.
    """
    if tasks is None:
        if episode is not None:
            hint = "Write env.with_tasks(episodes), or EnvParams(bank, tasks=episodes)."
            raise ConfigError("an episode was asked for, but the environment has none", hint=hint)
        return jnp.full((), -1, jnp.int32), None
    if episode is None:
        episode = tasks.draw(key) if isinstance(tasks, TaskBank) else jax.random.randint(key, (), 0, len(tasks))
    number, rows = jnp.asarray(episode, jnp.int32), tasks.rows if isinstance(tasks, TaskBank) else tasks
    return number, jax.tree.map(lambda row: row[number % len(tasks)], rows)


def _pick_arrangement(
    config: EnvConfig,
    bank: HouseBank,
    house: Int[Array, ""],
    pos: Float[Array, "a 3"],
    source: Float[Array, "3"],
    key: Array,
) -> Int[Array, ""] | None:
    """Sample an arrangement whose bodies keep clear of agents and of the floor point below the source.

    It is -1, the initial poses, if none does. None without random arrangements; `ConfigError` if the bank has none.
    """
    if config.arrangement == "initial":
        return None
    check_arrangements(bank)
    below = source.at[2].add(-jnp.float32(config.source_height))
    return random_arrangement(bank, house, jnp.concatenate([pos, below[None]]), key)
