"""Doors, lamps and appliances that a click changes, and what a clicked object touches."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from home_mjx.bank.bank import HouseBank
from home_mjx.bank.records import SWITCH_KINDS
from home_mjx.schema.semantic import Semantic
from home_mjx.tasks.base.snapshot import contact_semantics
from home_mjx.tasks.base.state import EnvParams, State
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.viewer.browser.object_card import name_object
from home_mjx.viewer.browser.scene.house_scene import MOVING, InstanceGroup

DOOR_UNIT = {True: "m", False: "rad"}  # of sliding leaves, and of hinged ones


def find_door(bank: HouseBank, house: int, group: InstanceGroup, index: int) -> int | None:
    """Return the door row of an instance; None if it is no door.

    Dynamic instances are the movable bodies, then the doors, then the agents.
    """
    door = int(group.entries[index]) - bank.spec.num_bodies
    is_door = group.layer == MOVING and 0 <= door < bank.spec.num_doors
    return door if is_door and bool(bank.physics.door_valid[house, door]) else None


def toggle_door(env: Env[HouseholdEnv], state: State, door: int) -> State:
    """Return a state of one environment with a door fully open, or closed if it is nearer to open; at rest.

    Observations stay those before, until the next step. An object in the way is pushed by physics.
    """
    house, physics = int(state.world.house), env.bank.physics
    layout = env.core.template(env.bank).layout
    place = int(np.arange(len(state.physics.qpos))[layout.door_qpos][door])
    closed, wide = float(physics.door_closed[house, door]), float(physics.door_fully_open[house, door])
    angle = float(state.physics.qpos[place])
    target = wide if abs(angle - closed) <= abs(angle - wide) else closed
    qpos = state.physics.qpos.at[place].set(jnp.float32(target))
    speed = int(np.arange(len(state.physics.qvel))[layout.door_qvel][door])
    return state.replace(physics=state.physics.replace(qpos=qpos, qvel=state.physics.qvel.at[speed].set(0.0)))


def find_switch(bank: HouseBank, house: int, object_id: int) -> int | None:
    """Return the row of an object among the house's lamps and appliances; None if it is none."""
    instance = np.asarray(bank.switches.instance[house])
    ids = np.asarray(bank.geometry.instance_object[house])
    found = np.flatnonzero((instance >= 0) & (ids[np.maximum(instance, 0)] == object_id) & (object_id >= 0))
    return int(found[0]) if len(found) else None


def toggle_switch(state: State, switch: int) -> State:
    """Return a state with a lamp or appliance on instead of off, or the reverse; the environment must have states.

    Observations stay those before, until the next step.
    """
    on = state.world.switch_on
    assert on is not None
    return state.replace(world=state.world.replace(switch_on=on.at[switch].set(~on[switch])))


class ObjectConditions:
    """Present conditions of clicked objects; the program for their contacts is compiled once.

    Args:
        env: The environment.
    """

    def __init__(self, env: Env[HouseholdEnv]) -> None:
        self.env, self._look = env, jax.jit(self._seen)

    def describe(self, state: State, group: InstanceGroup, index: int) -> dict[str, str]:
        """Return joint, state and contact of an instance by name, for its card; absent ones are left out."""
        lines = _describe_parts(self.env, state, group, index)
        touched = self._touch(state, int(group.entries[index])) if group.layer == MOVING else None
        return lines if touched is None else {**lines, "touches": touched}

    def _touch(self, state: State, entry: int) -> str | None:
        """Return what a dynamic instance touches most strongly, and the force [N]; None if nothing."""
        places, impulses, partners, others = (np.asarray(x) for x in self._look(self.env.params, state))
        agents = self.env.core.config.num_agents
        row = (entry + agents) % len(places)  # agents are the first bodies, but the last dynamic instances
        impulse, partner = float(impulses[row]), int(partners[row])
        if impulse <= 0 or partner == -1:
            return None
        is_agent = 0 <= partner < agents
        name = f"agent {partner + 1}" if is_agent else f"the {name_object(int(others[row][Semantic.FINE]))}"
        return f"{name}, {impulse / self.env.dt:.3g} N"

    def _seen(self, params: EnvParams, state: State) -> tuple[Any, ...]:
        """Return dynamic instances, and impulses, partners and their semantics of all bodies; to be jitted."""
        snapshot = self.env.core.snapshot(params, state)
        contacts = snapshot.body_contacts
        other = contact_semantics(snapshot.scene, contacts).other
        return snapshot.scene.moving.instance, contacts.contact_impulse, contacts.contact_partner, other


def _describe_parts(env: Env[HouseholdEnv], state: State, group: InstanceGroup, index: int) -> dict[str, str]:
    """Return the present joint and state of an instance by name; absent ones are left out."""
    house, bank = int(state.world.house), env.bank
    door, switch = find_door(bank, house, group, index), find_switch(bank, house, int(group.objects[index]))
    lines = {} if door is None else {"joint": _describe_joint(env, state, door)}
    if switch is not None:
        kind, on = SWITCH_KINDS[int(bank.switches.kind[house, switch])], state.world.switch_on
        hint = "no states; give --env switches=initial"
        lines[kind] = hint if on is None else f"{'on' if bool(on[switch]) else 'off'}; click to change"
    return lines


def _describe_joint(env: Env[HouseholdEnv], state: State, door: int) -> str:
    """Return kind, coordinate and range of a door's joint."""
    physics, house = env.bank.physics, int(state.world.house)
    place = np.arange(len(state.physics.qpos))[env.core.template(env.bank).layout.door_qpos][door]
    low, high, now = (float(x) for x in (physics.door_low[house, door], physics.door_high[house, door],
                                         state.physics.qpos[int(place)]))  # fmt: skip
    slides = bool(np.any(np.asarray(physics.door_slide[house, door]) != 0))
    unit = DOOR_UNIT[slides]
    return f"{'sliding' if slides else 'hinge'} at {now:.2f} {unit}, {low:.2f} to {high:.2f} {unit}"
