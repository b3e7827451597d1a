"""One environment at one instant, as tasks and sensors read it."""

from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int, UInt32

from home_mjx.audio_jax.base.endpoints import Head, Sounds
from home_mjx.audio_jax.contact_sounds.slots import Noises
from home_mjx.bank.bank import HouseBank
from home_mjx.core.pytree import Pytree, static
from home_mjx.navigation import room_of
from home_mjx.physics import PhysicsState, Scale
from home_mjx.physics.base.touch import FLOOR, STATIC
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.tasks.base.config import EnvConfig
from home_mjx.tasks.base.pose import AgentPose
from home_mjx.tasks.variation.draw import Drawn, Mount

UNDERFOOT = 0.15  # [m]: a box of the architecture that reaches no higher above the bottom of what touches it is a floor


class Touch(Pytree):
    """What touched each mobile in the last step: agents, then movable bodies, then doors; see `PhysicsState`."""

    impulse: Float[Array, " m"]  # [N s], of all contacts
    place: Float[Array, "m 3"]  # [m], of the strongest
    other: Int[Array, " m"]  # what that was with: a mobile; -1 nothing, -2 the floor, -3 - c static box c


class Snapshot(Pytree):
    """A agents in one house. Built where it is used and never stored, so that what nobody reads costs nothing."""

    step: Int[Array, ""]  # steps since reset; 0: the episode has just begun
    key: UInt32[Array, "2"]  # of the episode
    pose: AgentPose
    velocity: Float[Array, "a 3"]  # forward and left [m/s], yaw rate [rad/s]
    stopped: Bool[Array, " a"]  # has chosen the discrete action `stop`, and does nothing more
    said: Int[Array, " a"]  # token of the word that it said in the last step; -1 none
    contact: Bool[Array, " a"]  # touched anything but the floor during the last step
    held: Int[Array, " a"]  # movable body in each hand; -1 none
    door_angle: Float[Array, " h"]  # [rad] about +z from as placed, of what slides [m]
    touch: Touch
    sounds: Sounds
    action: Float[Array, "a n"]  # the last one: numbers, or 1 at the chosen move; 0 at the start
    reward: Float[Array, " a"]  # the last one; 0 at the start, and while the task computes the next
    scene: Scene  # the same as rays see it
    tasks: Any  # `EnvParams.tasks`
    config: EnvConfig = static()
    drawn: Drawn | None = None  # of what varies from episode to episode
    noises: Noises | None = None  # of bodies, with `EnvConfig.noises`
    head: Head | None = None  # `EnvParams.head`

    @property
    def bank(self) -> HouseBank:
        """The houses."""
        return self.scene.bank

    @property
    def house(self) -> Int[Array, ""]:
        """Index into the bank."""
        return self.scene.house

    @property
    def bodies(self) -> Scale | None:
        """Friction and mass of movable bodies in this episode against the house's; None: the same."""
        return None if self.drawn is None else self.drawn.bodies

    @property
    def mount(self) -> Mount | None:
        """How cameras are mounted in this episode; None: as their options say."""
        return None if self.drawn is None else self.drawn.mount

    @property
    def source(self) -> Float[Array, "3"]:
        """Where the first sound comes from [m]."""
        return self.sounds.pos[0]

    def of_first(self, num_agents: int) -> "Snapshot":
        """The same instant for the first agents alone; the others are things in it: in `scene`, `touch` and `sounds`.

        Example:
            >>> own = snapshot.of_first(core.num_agents)  # doctest: +SKIP
        """
        if num_agents == self.config.num_agents:
            return self
        per_agent = self.pose, self.velocity, self.stopped, self.said, self.contact, self.held, self.action, self.reward
        pose, velocity, stopped, said, contact, held, action, reward = jax.tree.map(lambda x: x[:num_agents], per_agent)
        return self.replace(
            pose=pose, velocity=velocity, stopped=stopped, said=said, contact=contact, held=held, action=action,
            reward=reward, config=self.config.of_first(num_agents),
        )  # fmt: skip


class TouchMeaning(Pytree):
    """What met in the strongest contact of each mobile: rows as of `bank.semantics`, columns `Semantic`; -1 unknown."""

    own: Int[Array, "m columns"]  # of the mobile itself
    other: Int[Array, "m columns"]  # of what touched it; -1 nothing, and what lies outdoors


def touch_meaning(scene: Scene, touch: Touch | PhysicsState) -> TouchMeaning:
    """Category, material and whatever else is known of both sides of each mobile's strongest contact.

    Of objects these are their own. The floor and walls are those of the room that the mobile is in, and of its walls
    the first one; so are invisible barriers.

    Args:
        scene: Where everything is.
        touch: What touched each mobile.

    Example:
        >>> meaning = touch_meaning(snapshot.scene, snapshot.touch)  # doctest: +SKIP
        >>> on_glass = meaning.other[:, Semantic.MATERIAL] == number_of(Semantic.MATERIAL, "glass")  # doctest: +SKIP
    """
    bank, house, moving = scene.bank, scene.house, scene.moving
    agents = moving.instance.shape[0] - bank.spec.num_bodies - bank.spec.num_doors  # they are the last there
    there, own, box = (jnp.roll(x, agents, axis=0) for x in (moving.instance >= 0, moving.semantic, moving.box))
    own = jnp.where(there, own, -1)
    box = jnp.where(there[:, None, None], box, 0.0)
    fixed = _fixed_rows(bank, house, touch.other, box)
    other = jnp.where(touch.other >= 0, own[touch.other], fixed)
    return TouchMeaning(*(jnp.where(row[:, None] < 0, -1, bank.semantics[row]) for row in (own, other)))


def _fixed_rows(
    bank: HouseBank, house: Int[Array, ""], other: Int[Array, " m"], box: Float[Array, "m 2 3"]
) -> Int[Array, " m"]:
    """Semantic rows of what does not move but touches mobiles with these bounds; -1 where a mobile or nothing does."""
    physics, number = bank.physics, jnp.maximum(STATIC - other, 0)
    static, item = other <= STATIC, physics.collider_object[house, number]
    top = physics.collider_pos[house, number, 2] + physics.collider_size[house, number, 2]
    on_floor = (other == FLOOR) | (top < box[:, 0, 2] + jnp.float32(UNDERFOOT))
    room = jax.vmap(lambda at: room_of(bank, house, at))(box.mean(axis=1))
    floor, wall = jnp.where(room[:, None] < 0, -1, bank.navigation.room_surface[house, room]).T
    row = jnp.where(item >= 0, bank.geometry.object_semantic[house, item], jnp.where(on_floor, floor, wall))
    return jnp.where(other == FLOOR, floor, jnp.where(static, row, -1))
