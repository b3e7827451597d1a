"""One environment at one instant, as tasks and sensors read it."""

from jaxtyping import Array, Bool, Float, Int, UInt32

from home_mjx.bank.bank import HouseBank
from home_mjx.core.pytree import Pytree
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.tasks.base.pose import AgentPose


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
    contact: Bool[Array, " a"]  # touched anything but the floor during the last step
    held: Int[Array, " a"]  # movable body in each hand; -1 none
    door_angle: Float[Array, " h"]  # [rad], about +z from as placed
    touch: Touch
    source: Float[Array, "3"]  # [m], where the sound comes from
    scene: Scene  # the same as rays see it

    @property
    def bank(self) -> HouseBank:
        """The houses."""
        return self.scene.bank

    @property
    def house(self) -> Int[Array, ""]:
        """Index into the bank."""
        return self.scene.house
