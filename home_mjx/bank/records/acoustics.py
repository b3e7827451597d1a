"""Acoustic records of a bank: reflecting planes, diffracting edges and baked late reverberation."""

import jax
import numpy as np
from jaxtyping import Array, Bool, Float, Int, Int8, UInt8

from home_mjx.bank.records.owners import HouseOwner
from home_mjx.bank.records.physics import PADDING_POS
from home_mjx.core.pytree import Pytree, array


def is_plane(at: HouseOwner) -> Bool[np.ndarray, " p"]:
    """Return the mask of planes: True for each plane of the house; padding is False."""
    return np.ones(len(at.house.planes.material), bool)


class Acoustics(Pytree):
    """Reflecting planes and diffracting edges of every house."""

    plane_valid: Bool[Array, "h planes"] = array("False padding", source=is_plane, fill=False)
    plane_center: Float[Array, "h planes 3"] = array("[m]", source="planes.center", fill=PADDING_POS)
    plane_normal: Float[Array, "h planes 3"] = array("unit", source="planes.normal", fill=np.array([0, 0, 1]))
    plane_u: Float[Array, "h planes 3"] = array(
        "[m], half extent vector", source="planes.axis_u", fill=np.array([1, 0, 0])
    )
    plane_v: Float[Array, "h planes 3"] = array(
        "[m], half extent vector", source="planes.axis_v", fill=np.array([0, 1, 0])
    )
    collider_edges: Int[Array, "h colliders"] = array(
        "bits of the exposed edges of static boxes, see `geometry.diffraction_edges`", source="exposed_edges"
    )


LATE_REVERB = "late_reverb"  # name of the bake whose record is a `LateReverb`


class LateReverb(Pytree):
    """Baked late reverberation of every house h, with all doors fully open.

    Rooms are divided into cells. Sound between two cells first arrives in the time bin `arrival`; its energy from that
    bin on is stored per octave and time span. The decay within a span follows that between the cells' rooms, `shape`.
    Logarithms are natural. The other arrays are an energy balance of the rooms, which accounts for doors and walls.
    """

    arrival: UInt8[Array, "h n n"]  # time bin of the first sound from cell to cell, around obstacles
    level: Float[Array, "h n n spans bands"]  # log energy re the free field at 1 m
    comes_from: Int8[Array, "h n n spans 3"]  # mean direction of arrival at the second cell, in 1 / 127
    room: Int[Array, "h n"]  # room of each cell
    shape: Float[Array, "h r r bands knots"]  # log energy per time bin, normalized to 1 per span
    near: UInt8[Array, "h levels rows columns e"]  # cells around each grid point
    weight: Float[Array, "h levels rows columns e"]  # weights of these cells; they sum to 1
    floor: Float[Array, "h levels"]  # [m], height; inf padding
    origin: Float[Array, "h 2"]  # [m], corner of grid point (0, 0)
    step: Float[Array, " h"]  # [m], grid spacing
    num_rooms: Int[Array, " h"]  # number of rooms; later ones are padding
    volume: Float[Array, "h r"]  # [m³], volume of each room; 1 padding
    loss: Float[Array, "h r bands"]  # [1/m], fraction of a room's energy absorbed by surfaces and air
    opening: Float[Array, "h r r bands"]  # [m²], exchange of rooms through openings: volume times fraction per metre
    wall: Float[Array, "h r r bands"]  # [m²], exchange through walls
    portal_room: Int[Array, "h p 2"]  # rooms that each portal connects
    portal_share: Float[Array, "h p"]  # fraction of its rooms' exchange; 0 padding
    portal_leaf: Int[Array, "h p 2"]  # rows of the leaves that close it; -1 none
    portal_leak: Float[Array, "h p bands"]  # energy fraction transmitted by closed leaves

    @property
    def nbytes(self) -> int:
        """Bytes of all arrays."""
        return sum(x.nbytes for x in jax.tree.leaves(self))
