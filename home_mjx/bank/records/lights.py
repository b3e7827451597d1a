"""Light records of a bank."""

import numpy as np
from jaxtyping import Array, Bool, Float, Int, UInt32

from home_mjx.bank.records.owners import HouseOwner
from home_mjx.bank.records.physics import PADDING_POS
from home_mjx.core.pytree import Pytree, array
from home_mjx.schema.compiled import CompiledHouse

PADDING_DIRECTION = np.array([0.0, 0.0, -1.0])


def count_glowing(house: CompiledHouse) -> int:
    """Count the materials of a house that emit."""
    return int(_emits(house).sum())


def glowing_rows(at: HouseOwner) -> Int[np.ndarray, " g"]:
    """Return the rows of the bank's materials that emit."""
    return at.start["material"] + at.house.materials.maps.row[_emits(at.house)]


def glow_colors(at: HouseOwner) -> Float[np.ndarray, "g 3"]:
    """Return the emission of the materials of `glowing_rows`."""
    return at.house.materials.maps.glow[_emits(at.house)]


def _emits(house: CompiledHouse) -> Bool[np.ndarray, " m"]:
    """Return a mask of the rows of maps that emit."""
    return house.materials.maps.glow.max(axis=1, initial=0) > 0


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
    glowing: Int[Array, "h glowing"] = array("row of a material that emits; -1 padding", source=glowing_rows, fill=-1)
    glow: Float[Array, "h glowing 3"] = array("linear light, 1: as bright as a white display", source=glow_colors)


LIGHT_PROBES = "light_probes"  # name of the bake whose record is a `LightProbes`
NUM_KEY_LAMPS = 2  # lamps of a room whose direct light is not in its probes
# Light groups: lamps of the probe's room and of others; sky at the zenith with the ground, at the horizon; suns.
OWN_LAMPS, OTHER_LAMPS, ZENITH, HORIZON, SUNS = range(5)
SUN_AZIMUTHS = (10.0, 70.0, 130.0, 190.0, 250.0, 310.0)  # [degrees], equally spaced
SUN_ELEVATION = 35.0  # [degrees]
NUM_GROUPS = SUNS + len(SUN_AZIMUTHS)
# Further groups of texels: direct light of the room's key lamps, and of a sun at `TEXEL_SUN_AZIMUTH`.
KEY_LAMPS, KEY_SUN = NUM_GROUPS, NUM_GROUPS + 1
TEXEL_SUN_AZIMUTH = 250.0  # [degrees]
NUM_TEXEL_GROUPS = NUM_GROUPS + 2


class LightProbes(Pytree):
    """Baked light at points of every house's rooms, one lattice of probes per room.

    A probe has the irradiance on planes that face +x, -x, +y, -y, +z and -z, per light group: of lamps in [W/m^2], of
    sky groups per radiance of the sky, of suns per normal irradiance. Sky groups have white horizon and the shader's
    zenith and ground. Direct light of suns and of `keys` is not in it. A room's probes follow each other, z fastest,
    then y.

    Faces of the architecture have charts, which are grids of texels. A texel has the irradiance on its face per group,
    and in two more groups the direct light of the key lamps of its room and of the sun at `TEXEL_SUN_AZIMUTH`.
    """

    light: UInt32[Array, "h probes groups 6"]  # colours packed as by `light_probes.field.pack_colors`
    room: Int[Array, "h probes"]
    first: Int[Array, "h rooms"]  # first probe of a room; -1 none
    origin: Float[Array, "h rooms 3"]  # [m], its position
    step: Float[Array, "h rooms 3"]  # [m], distances to the next probes
    count: Int[Array, "h rooms 3"]  # numbers of probes along the axes, at least 2
    keys: Int[Array, "h rooms k"]  # rows of the light table of the lamps that need shadow rays; -1 none
    spill: Float[Array, "h rooms rooms"]  # shares of the other rooms' lamps in group `OTHER_LAMPS`; rows sum to 1 or 0
    texel: UInt32[Array, "h texels texel_groups"]  # colours packed alike; charts with their two axes, second fastest
    texel_room: Int[Array, "h texels"]
    chart_start: Int[Array, "h instances"]  # row in `chart` of the first triangle of instances; -1 none has a chart
    chart: Int[Array, "h triangles"]  # chart of each triangle of these instances; -1 none
    chart_frame: Float[Array, "h charts 3 3"]  # position of the first texel [m], vectors along both axes [1/m]
    chart_count: Int[Array, "h charts 2"]  # numbers of texels along the axes, at least 2
    chart_first: Int[Array, "h charts"]  # first texel of each chart
