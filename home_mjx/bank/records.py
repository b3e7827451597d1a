"""The arrays of a `HouseBank`, grouped by the engine that reads them."""

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int, UInt16, UInt32

from home_mjx.bank.packing.gpu_geometry import GpuGeometry
from home_mjx.core.pytree import Pytree, static


class Geometry(Pytree):
    """What rays need: the shared model library and each house's instances.

    Triangle and node indices are absolute in these arrays. Instance indices run over [0, I) per house, row 0 being
    the architecture; agents follow as I + a. Tree codes are those of `compiled.Tree`, except that they are absolute.
    """

    node_box: Float[Array, "n 2 6"]  # per child: min xyz, max xyz
    node_child: Int[Array, "n 2"]  # >= 0 node; < 0 leaf: ~code = first << 4 | count
    triangle: Float[Array, "t 3 3"]  # [m], model frame
    triangle_uv: Float[Array, "t 3 2"]
    triangle_slot: Int[Array, " t"]
    triangle_part: Int[Array, " t"]
    model_root: Int[Array, " m"]  # root node of the model's tree
    model_box: Float[Array, "m 2 3"]
    house_root: Int[Array, " h"]  # root node of the top tree over static instances (leaves hold instance indices)
    instance_model: Int[Array, "h i"]  # -1 padding
    instance_pose: Float[Array, "h i 3 4"]  # world from model
    instance_inverse: Float[Array, "h i 3 4"]  # model from world
    instance_object: Int[Array, "h i"]  # object id (node index); -1 architecture and padding
    instance_material: Int[Array, "h i"]  # first material row, absolute
    instance_semantic: Int[Array, "h i"]  # first semantic row, absolute
    instance_body: Int[Array, "h i"]  # movable slot or -1 static
    object_semantic: Int[Array, "h i"]  # semantic row of each object id, absolute; -1 none
    material_mask: Int[Array, " r"]  # Ray bits that each material row stops
    agent_model: Int[Array, ""]  # library model of an agent (unit: its real size)
    agent_material: Int[Array, ""]
    agent_semantic: Int[Array, ""]
    gpu: GpuGeometry | None = None  # the same once more for the `cuda` ray executor; None: it lays it out at each cast

    def known_house(self, house: Int[Array, "*n"] | int) -> Int[Array, "*n"]:
        """The nearest index of a house that there is; JAX's own indexing would take negative ones from the end."""
        return jnp.clip(house, 0, self.house_root.shape[0] - 1)


class Materials(Pytree):
    """The bank's one material table."""

    albedo: Float[Array, "r 4"]  # linear-light diffuse 0..1, and opacity
    texture: Int[Array, " r"]  # layer in `textures`; -1 none
    kind: Int[Array, " r"]  # index into MATERIAL_KINDS; -1 unknown
    absorption: Float[Array, "r 7"]  # energy fractions, octaves 125 .. 8000 Hz
    scattering: Float[Array, "r 7"]
    transmission: Float[Array, "r 7"]
    textures: UInt32[Array, "l p"]  # sRGB, alpha highest; mip levels after one another, row 0 is the top (v = 1)


class Physics(Pytree):
    """Static boxes and movable bodies of every house."""

    floor: Float[Array, " h"]  # [m], top of the ground floor
    collider_pos: Float[Array, "h c 3"]  # [m]; padding is parked far below
    collider_quat: Float[Array, "h c 4"]
    collider_size: Float[Array, "h c 3"]  # [m], half extents
    body_valid: Bool[Array, "h k"]
    body_instance: Int[Array, "h k"]  # -1 padding
    body_pos: Float[Array, "h k 3"]  # [m]
    body_quat: Float[Array, "h k 4"]
    body_size: Float[Array, "h k 3"]  # [m], half extents
    body_mass: Float[Array, "h k"]  # [kg]
    body_inertia: Float[Array, "h k 3"]  # [kg m^2], principal
    body_from_model: Float[Array, "h k 3 4"]


class Acoustics(Pytree):
    """Mirror planes of every house."""

    plane_valid: Bool[Array, "h p"]
    plane_center: Float[Array, "h p 3"]  # [m]
    plane_normal: Float[Array, "h p 3"]
    plane_u: Float[Array, "h p 3"]  # [m], half extent vector
    plane_v: Float[Array, "h p 3"]
    plane_material: Int[Array, "h p"]  # absolute row


class Navigation(Pytree):
    """Grids of every house and level, starts, goals, portals; see `compiled.Navigation`.

    Cells in which agents can be (those of the home region) are numbered through all houses.
    """

    origin: Float[Array, "h 2"]  # [m], corner of cell (0, 0) of a house's grids
    floor: Float[Array, "h l"]  # [m], of each level that has rooms, from below; inf padding
    first_cell: Int[Array, " h"]
    num_cells: Int[Array, " h"]
    cell: Int[Array, "h l ny nx"]  # row of `place` and `field`; -1 where agents cannot be
    place: Int[Array, "c 3"]  # level, row and column
    field: UInt16[Array, "c g"]  # [FIELD_UNIT], geodesic distance to each goal of the cell's house; FIELD_FAR no path
    region: Int[Array, "h l ny nx"]  # 0 the home region, then by area; -1 where nobody can stand
    room: Int[Array, "h l ny nx"]  # -1 outside
    room_type: Int[Array, "h rooms"]
    start: Float[Array, "h s 3"]  # [m], on the floor
    goal: Float[Array, "h g 3"]
    portal_room: Int[Array, "h p 2"]  # -1 outdoors, and padding
    portal_pos: Float[Array, "h p 3"]  # [m]
    portal_width: Float[Array, "h p"]  # [m], that agents can cross; 0: closed to them, and padding
    portal_kind: Int[Array, "h p"]  # compiled.PortalKind; -1 padding
    room_hops: Int[Array, "h rooms rooms"]  # portals on the way from room to room; -1 no way


class Finish(Pytree):
    """How surfaces take light besides their diffuse colour."""

    normal: Float[Array, "t 3 3"]  # unit, of the corners of `Geometry.triangle`, model frame
    specular: Float[Array, "r 3"]  # linear light, by material row
    shininess: Float[Array, " r"]  # Blinn-Phong exponent
    mirror: Bool[Array, " r"]


class Lights(Pytree):
    """The lights of every house, in the frames of the instances that carry them; see `lighting.LightTable`."""

    pos: Float[Array, "h l 3"]  # [m]
    axis_u: Float[Array, "h l 3"]  # [m], half extents
    axis_v: Float[Array, "h l 3"]
    direction: Float[Array, "h l 3"]
    intensity: Float[Array, "h l 3"]  # [W/sr]; of daylight [m^2], times the sky's radiance; 0 padding
    exponent: Float[Array, "h l"]
    cutoff: Float[Array, "h l"]
    area: Float[Array, "h l"]  # [m^2]
    daylight: Bool[Array, "h l"]
    instance: Int[Array, "h l"]  # -1 padding
    room: Int[Array, "h l"]
    ambient: Float[Array, "h rooms_and_none 2 3"]  # [W/m^2] by room + 1 and source: lamps, daylight


class BankSpec(Pytree):
    """Static capacities, rounded to size classes so that similar banks share one compiled step."""

    num_instances: int = static()
    num_bodies: int = static()
    num_colliders: int = static()
    num_planes: int = static()
    num_starts: int = static()
    num_goals: int = static()
    cell: float = static()  # [m], navigation grid


RECORDS: dict[str, type] = {
    "geometry": Geometry,
    "materials": Materials,
    "physics": Physics,
    "acoustics": Acoustics,
    "navigation": Navigation,
    "finish": Finish,
    "lights": Lights,
}


SIZES = ("num_instances", "num_bodies", "num_colliders", "num_planes", "num_starts", "num_goals")
