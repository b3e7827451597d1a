"""Mirror planes and edges, for sound."""

import numpy as np
from jaxtyping import Array, Bool, Float, Int
from scipy.spatial.transform import Rotation

from home_mjx.bank.records.bodies import PARKED
from home_mjx.bank.records.owners import HouseAt
from home_mjx.core.pytree import Pytree, array
from home_mjx.scene_compile.geometry.box_edges import exposed_edges
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
