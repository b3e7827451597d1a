"""Mirror planes and edges, for sound; and what has been baked of it."""

import jax
import numpy as np
from jaxtyping import Array, Bool, Float, Int, Int8, UInt8
from scipy.spatial.transform import Rotation

from home_mjx.bank.records.bodies import PARKED
from home_mjx.bank.records.owners import HouseAt
from home_mjx.core.pytree import Pytree, array
from home_mjx.geometry.box_edges import exposed_edges
from home_mjx.schema.edges import EDGES


def is_plane(at: HouseAt) -> Bool[np.ndarray, " p"]:
    """True for each plane."""
    return np.ones(len(at.house.planes.material), bool)


def plane_material(at: HouseAt) -> Int[np.ndarray, " p"]:
    """Material row of each plane."""
    return at.house.planes.material + at.start["material"]


def edge_bits(at: HouseAt) -> Int[np.ndarray, " c"]:
    """Edges of static boxes with air around them, one bit each in the order of `schema.edges`."""
    boxes, rooms = at.house.colliders, at.house.rooms
    turn = Rotation.from_quat(boxes.quat, scalar_first=True).as_matrix()
    heights = np.stack([rooms.floor, rooms.ceiling], axis=1)
    return exposed_edges(boxes.pos, turn, boxes.size, heights) @ (1 << np.arange(EDGES))


class Acoustics(Pytree):
    """Mirror planes of every house, and edges around which sound bends."""

    plane_valid: Bool[Array, "h planes"] = array("False padding", source=is_plane, fill=False)
    plane_center: Float[Array, "h planes 3"] = array("[m]", source="planes.center", fill=PARKED)
    plane_normal: Float[Array, "h planes 3"] = array("unit", source="planes.normal", fill=np.array([0, 0, 1]))
    plane_u: Float[Array, "h planes 3"] = array(
        "[m], half extent vector", source="planes.axis_u", fill=np.array([1, 0, 0])
    )
    plane_v: Float[Array, "h planes 3"] = array(
        "[m], half extent vector", source="planes.axis_v", fill=np.array([0, 1, 0])
    )
    plane_material: Int[Array, "h planes"] = array("absolute row", source=plane_material)
    collider_edges: Int[Array, "h colliders"] = array(
        "bits: which edges of static boxes have air around them, see `schema.edges`", source=edge_bits
    )


LATE_REVERB = "late_reverb"  # name of the bake whose record is a `LateSound`


class LateSound(Pytree):
    """What is kept of the late sound of every house h, with all doors wide open.

    Rooms are divided into cells. Between two of them sound is first heard in the time bin `arrival`; its energy is
    kept per octave for some spans of time from that bin on. Within a span time runs as it does between the cells'
    rooms, `shape`. Logarithms are natural ones. The rest is an energy balance of the rooms, for what doors and walls
    change.
    """

    arrival: UInt8[Array, "h n n"]  # in which sound comes first from cell to cell, around what stands in between
    level: Float[Array, "h n n spans bands"]  # logarithm of the energy re the free field at 1 m
    comes_from: Int8[Array, "h n n spans 3"]  # mean direction in which the second cell hears the first, in 1 / 127
    room: Int[Array, "h n"]  # of each cell
    shape: Float[Array, "h r r bands knots"]  # logarithm of the energy per time bin, of which each span holds 1
    near: UInt8[Array, "h levels rows columns e"]  # cells around each place
    weight: Float[Array, "h levels rows columns e"]  # of these; they add up to 1
    floor: Float[Array, "h levels"]  # [m]; inf padding
    origin: Float[Array, "h 2"]  # [m], corner of place (0, 0)
    step: Float[Array, " h"]  # [m], between places
    volume: Float[Array, "h r"]  # [m³], of each room
    loss: Float[Array, "h r bands"]  # [1/m], share of a room's energy that its surfaces and air take
    opening: Float[Array, "h r r bands"]  # [m²], exchange of rooms through openings: volume times share per metre
    wall: Float[Array, "h r r bands"]  # [m²], the same through walls
    portal_room: Int[Array, "h p 2"]  # the rooms that each portal joins
    portal_share: Float[Array, "h p"]  # of the exchange of its rooms; 0 padding
    portal_leaf: Int[Array, "h p 2"]  # rows of the leaves that can close it; -1 none
    portal_leak: Float[Array, "h p bands"]  # energy that these let through, as a fraction

    @property
    def nbytes(self) -> int:
        """Bytes of all arrays."""
        return sum(x.nbytes for x in jax.tree.leaves(self))
