"""Mirror planes, for sound."""

import numpy as np
from jaxtyping import Array, Bool, Float, Int

from home_mjx.bank.records.bodies import PARKED
from home_mjx.bank.records.owners import HouseAt
from home_mjx.core.pytree import Pytree, array


def is_plane(at: HouseAt) -> Bool[np.ndarray, " p"]:
    """True for each plane."""
    return np.ones(len(at.house.planes.material), bool)


def plane_material(at: HouseAt) -> Int[np.ndarray, " p"]:
    """Material row of each plane."""
    return at.house.planes.material + at.start["material"]


class Acoustics(Pytree):
    """Mirror planes of every house."""

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
