"""One environment at one instant, as tasks and sensors read it."""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int, UInt32

from home_mjx.audio_jax.base.endpoints import MeasuredHead, SoundSources
from home_mjx.audio_jax.contact_sounds.sound_slots import ContactSounds
from home_mjx.bank.bank import HouseBank
from home_mjx.core.pytree import Pytree, static
from home_mjx.navigation import room_below
from home_mjx.physics import BodyScale, PhysicsState
from home_mjx.physics.base.state import FLOOR, STATIC
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.tasks.base.config import EnvConfig
from home_mjx.tasks.base.specs import WALK_NAMES
from home_mjx.tasks.variation.sample import CameraOffsets, VariationSample

MAX_FLOOR_BOX_HEIGHT = 0.15  # [m], maximum height above a body's bottom of tops of static boxes that count as floor


class AgentPose(Pytree):
    """Pose of every agent: capsule centre [m], yaw [rad] about +z from +x, pitch [rad], up is positive."""

    pos: Float[Array, "a 3"]
    yaw: Float[Array, " a"]
    pitch: Float[Array, " a"]


def map_agents(function: Callable[..., Any], *args: Any) -> Any:
    """Map a function of one agent over the leading agent axis of `args`, kept in results; one agent needs no `vmap`."""
    if jax.tree.leaves(args)[0].shape[0] > 1:
        return jax.vmap(function)(*args)
    return jax.tree.map(lambda x: x[None], function(*jax.tree.map(lambda x: x[0], args)))


class BodyContacts(Pytree):
    """Contacts of each dynamic body in the last step: agents, then movable bodies, then doors; see `PhysicsState`."""

    contact_impulse: Float[Array, " m"]  # [N s], sum over all contacts
    contact_pos: Float[Array, "m 3"]  # [m], position of the strongest contact
    # the other body of the strongest contact; -1 none, -2 the floor, -3 - c static box c
    contact_partner: Int[Array, " m"]


class Snapshot(Pytree):
    """A agents in one house. Built where it is used and never stored, so XLA removes the fields that nobody reads."""

    step: Int[Array, ""]  # steps since reset; 0: the episode has just begun
    key: UInt32[Array, "2"]  # of the episode
    pose: AgentPose
    velocity: Float[Array, "a 3"]  # forward and left [m/s], yaw rate [rad/s]
    stopped: Bool[Array, " a"]  # has chosen the discrete action `stop`, see `Task.stop_is_final`
    spoken_token: Int[Array, " a"]  # token of the word spoken in the last step; -1 none
    in_contact: Bool[Array, " a"]  # touched anything but the floor during the last step
    held: Int[Array, " a"]  # movable body in each hand; -1 none
    door_angle: Float[Array, " h"]  # [rad] about +z from the angle in the file; of sliding leaves the shift [m]
    body_contacts: BodyContacts
    sounds: SoundSources
    action: Float[Array, "a n"]  # the last action: numbers, or one-hot for discrete moves; 0 at the start
    reward: Float[Array, " a"]  # the last reward; 0 at the start; while the task computes the next, the one before
    scene: Scene  # the same instant for ray casting
    tasks: Any  # `EnvParams.tasks`
    config: EnvConfig = static()
    variation: VariationSample | None = None  # sample of the domain randomisation; None: nothing varies
    switch_on: Bool[Array, " s"] | None = None  # rows of the bank's `switches` that are on, with `EnvConfig.switches`
    contact_sounds: ContactSounds | None = None  # contact sounds, with `EnvConfig.contact_sounds`
    head: MeasuredHead | None = None  # `EnvParams.head`

    @property
    def bank(self) -> HouseBank:
        """Bank of the houses."""
        return self.scene.bank

    @property
    def house(self) -> Int[Array, ""]:
        """Index of the house in the bank."""
        return self.scene.house

    @property
    def body_scale(self) -> BodyScale | None:
        """Factors of friction and mass of movable bodies in this episode; None: 1."""
        return None if self.variation is None else self.variation.body_scale

    @property
    def camera_offsets(self) -> CameraOffsets | None:
        """Camera offsets of this episode; None: as in the options."""
        return None if self.variation is None else self.variation.camera_offsets

    @property
    def has_collided(self) -> Bool[Array, " a"]:
        """True where the last action was to walk and the agent touched anything but the floor, as Habitat counts it."""
        columns = [i for i, name in enumerate(self.config.action_names) if name in WALK_NAMES]
        walked = jnp.any(self.action[:, np.array(columns)] != 0, axis=1)
        return self.in_contact & walked

    @property
    def feet(self) -> Float[Array, "a 3"]:
        """Lowest point of every agent [m], by which cells, rooms, storeys and distances are looked up."""
        half = jnp.array([body.height / 2 for body in self.config.agents], jnp.float32)
        return self.pose.pos.at[:, 2].add(-half)

    @property
    def source(self) -> Float[Array, "3"]:
        """Position of the first sound source [m]."""
        return self.sounds.pos[0]

    def select_agents(self, num_agents: int) -> "Snapshot":
        """Return the snapshot of the first `num_agents` agents; the same object for all agents.

        `scene`, `body_contacts`, `sounds` and `contact_sounds` keep those of all.

        Example:
            >>> own = snapshot.select_agents(core.num_agents)  # doctest: +SKIP
        """
        if num_agents == self.config.num_agents:
            return self
        names = ("pose", "velocity", "stopped", "spoken_token", "in_contact", "held", "action", "reward")
        own = {name: jax.tree.map(lambda x: x[:num_agents], getattr(self, name)) for name in names}
        return self.replace(**own, config=self.config.select_agents(num_agents))


class ContactSemantics(Pytree):
    """Semantics of both sides of each dynamic body's strongest contact; -1 unknown.

    Rows are those of `bank.semantics`, columns `Semantic`.
    """

    body: Int[Array, "m columns"]  # of the body itself
    other: Int[Array, "m columns"]  # of the other side; -1 if there is none, or outdoors


def contact_semantics(scene: Scene, contacts: BodyContacts | PhysicsState) -> ContactSemantics:
    """Return category, material and other semantics of both sides of each dynamic body's strongest contact.

    Objects have semantics of their own. The floor and walls are those of the body's room, of its walls the first one.
    Invisible barriers count as walls.

    Example:
        >>> meaning = contact_semantics(snapshot.scene, snapshot.body_contacts)  # doctest: +SKIP
        >>> on_glass = meaning.other[:, Semantic.MATERIAL] == number_of(Semantic.MATERIAL, "glass")  # doctest: +SKIP
    """
    bank, house, moving = scene.bank, scene.house, scene.moving
    agents = moving.instance.shape[0] - bank.spec.num_bodies - bank.spec.num_doors  # agents come last there
    there, own, box = (jnp.roll(x, agents, axis=0) for x in (moving.instance >= 0, moving.semantic, moving.box))
    own = jnp.where(there, own, -1)
    box = jnp.where(there[:, None, None], box, 0.0)
    fixed = _static_semantic_rows(bank, house, contacts.contact_partner, box)
    other = jnp.where(contacts.contact_partner >= 0, own[contacts.contact_partner], fixed)
    return ContactSemantics(*(jnp.where(row[:, None] < 0, -1, bank.semantics[row]) for row in (own, other)))


def _static_semantic_rows(
    bank: HouseBank, house: Int[Array, ""], other: Int[Array, " m"], box: Float[Array, "m 2 3"]
) -> Int[Array, " m"]:
    """Return rows of `bank.semantics` for static contact partners `other` (codes of `BodyContacts`); -1 for others.

    `box` has the bounds of each body [m]. Boxes of objects have rows of their own. Others count as floor if their top
    is less than `MAX_FLOOR_BOX_HEIGHT` above the body's bottom, else as wall, of the room below the body's middle; -1
    outdoors.
    """
    physics, number = bank.physics, jnp.maximum(STATIC - other, 0)
    static, item = other <= STATIC, physics.collider_object[house, number]
    top = physics.collider_pos[house, number, 2] + physics.collider_size[house, number, 2]
    on_floor = (other == FLOOR) | (top < box[:, 0, 2] + jnp.float32(MAX_FLOOR_BOX_HEIGHT))
    room = jax.vmap(lambda at: room_below(bank, house, at))(box.mean(axis=1))
    floor, wall = jnp.where(room[:, None] < 0, -1, bank.navigation.room_surface[house, room]).T
    row = jnp.where(item >= 0, bank.geometry.object_semantic[house, item], jnp.where(on_floor, floor, wall))
    return jnp.where(other == FLOOR, floor, jnp.where(static, row, -1))
