"""Light records of a bank."""

import numpy as np
from jaxtyping import Array, Bool, Float, Int

from home_mjx.bank.records.physics import PADDING_POS
from home_mjx.core.pytree import Pytree, array

PADDING_DIRECTION = np.array([0.0, 0.0, -1.0])


class Lights(Pytree):
    """Lights of every house, in the frames of the instances that carry them; see `lighting.LightTable`."""

    pos: Float[Array, "h lights 3"] = array("[m]", source="lights.pos", fill=PADDING_POS)
    axis_u: Float[Array, "h lights 3"] = array("[m], half extents", source="lights.axis_u")
    axis_v: Float[Array, "h lights 3"] = array("[m], half extents", source="lights.axis_v")
    direction: Float[Array, "h lights 3"] = array("unit", source="lights.direction", fill=PADDING_DIRECTION)
    intensity: Float[Array, "h lights 3"] = array(
        "[W/sr]; for daylight [m^2], times the sky's radiance; 0 padding", source="lights.intensity"
    )
    exponent: Float[Array, "h lights"] = array("exponent of the cosine", source="lights.exponent")
    cutoff: Float[Array, "h lights"] = array("minimum cosine", source="lights.cutoff", fill=-2)
    area: Float[Array, "h lights"] = array("[m^2]", source="lights.area")
    daylight: Bool[Array, "h lights"] = array("True for windows", source="lights.daylight", fill=False)
    instance: Int[Array, "h lights"] = array(
        "instance that carries the light; -1 padding", source="lights.instance", fill=-1
    )
    room: Int[Array, "h lights"] = array("illuminated room; -1 none", source="lights.room", fill=-1)
    ambient: Float[Array, "h rooms_and_none 2 3"] = array(
        "[W/m^2] by room + 1 and source: lamps, daylight", source="lights.ambient"
    )
