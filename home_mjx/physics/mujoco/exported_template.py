"""C MuJoCo on exported houses: optional convex pieces, and MuJoCo's own floor contact."""

import xml.etree.ElementTree as ET
from collections.abc import Sequence
from typing import Any

import jax.numpy as jnp
import mujoco
import numpy as np

from home_mjx.bank.bank import HouseBank
from home_mjx.bank.records import Physics
from home_mjx.errors import ConfigError
from home_mjx.physics.base.config import PhysicsConfig, PhysicsSetup
from home_mjx.physics.base.layout import Layout
from home_mjx.physics.mjx.template import Template
from home_mjx.physics.mujoco.house_model import MujocoHouse
from home_mjx.physics.mujoco.house_models import PrebuiltHouses
from home_mjx.scene_compile.mjcf.export import instance_name, to_mjcf
from home_mjx.schema.compiled import CompiledHouse
from home_mjx.schema.mjcf import COLLIDES_WITH_LEAVES, FRICTIONLESS_CONTACT, add_agent


class ExportedTemplate(Template):
    """A template whose houses are exported MJCF, stepped by C MuJoCo; see `to_mjcf` for their contents.

    Args:
        config: Options, with `impl="c"`.
        bank: Houses.
        compiled: The same houses, in the bank's order.
        collision: `box` or `exact`, as in `to_mjcf`.

    Attributes:
        bank: Bank to use instead of the given one, with movable bodies at their models' initial poses. With convex
            pieces, these differ from the boxes' poses by up to 5 cm.

    Raises:
        ConfigError: `impl` is not "c", the houses differ from the bank's, or `to_mjcf` raises it.

    Example:
        >>> template = ExportedTemplate(PhysicsConfig(impl="c"), bank, houses, "exact")  # doctest: +SKIP
        >>> state = step(template, template.bank, house, state, action)  # doctest: +SKIP
    """

    def __init__(
        self, config: PhysicsConfig, bank: HouseBank, compiled: Sequence[CompiledHouse], collision: str = "box"
    ) -> None:
        if config.impl != "c":
            hint = 'Write PhysicsConfig(impl="c").'
            raise ConfigError("only C MuJoCo steps exported houses", element="PhysicsConfig.impl", hint=hint)
        if tuple(house.id for house in compiled) != bank.house_ids:
            hint = f"The bank's, in this order: {', '.join(bank.house_ids[:5])}, ..."
            raise ConfigError("`compiled` are not the bank's houses", element="ExportedTemplate", hint=hint)
        super().__init__(config, bank.spec)
        houses = [build_exported_model(self.config, self.layout, house, collision) for house in compiled]
        self.houses = PrebuiltHouses(self.config, self.layout, houses)
        self.bank = bank.replace(physics=_with_model_poses(bank.physics, self.layout, houses))


def build_exported_model(
    config: PhysicsSetup, layout: Layout, house: CompiledHouse, collision: str = "box"
) -> MujocoHouse:
    """Build C MuJoCo's model of an exported house with frictionless agents, and its index maps to the state.

    Rows of movable bodies and doors are those of the house in its bank; unused rows have no body. Visual geoms are left
    out, and an unstable state is not reset (`mjDSBL_AUTORESET`). In `qpos0`, agents are at the world's origin.

    Args:
        config: Options. `friction` and `restitution`, unless None, replace those of all movable bodies. The agents'
            bodies and the length of a physics step are used, too; solver options such as `iterations` are ignored.
        layout: Layout of the state, with the agents of `config` and at least the house's bodies and doors.
        house: A compiled house.
        collision: `box` or `exact`, as in `to_mjcf`, whose errors come through.
    """
    xml, files = to_mjcf(
        house,
        timestep=config.timing.sim_dt,
        friction=config.friction,
        restitution=config.restitution,
        collision=collision,
    )
    root = ET.fromstring(xml)
    ET.SubElement(root, "compiler", discardvisual="true")
    world = root.find("worldbody")
    assert world is not None
    for a, shape in enumerate(config.agents):
        add_agent(world, shape, f"agent{a}", **FRICTIONLESS_CONTACT, **COLLIDES_WITH_LEAVES)
    model = mujoco.MjModel.from_xml_string(ET.tostring(root, encoding="unicode"), files)  # pyright: ignore[reportAttributeAccessIssue]
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET  # pyright: ignore[reportAttributeAccessIssue]
    agents = [f"agent{a}" for a in range(layout.num_agents)]
    bodies, doors = [""] * layout.num_bodies, [""] * layout.num_doors
    for k, instance in enumerate(house.bodies.instance.tolist()):
        bodies[k] = instance_name(house, instance)
    rows = house.doors.bank_rows(layout.num_doors, layout.num_slides)
    for h, instance in zip(rows.tolist(), house.doors.instance.tolist(), strict=True):
        doors[h] = instance_name(house, instance)
    return MujocoHouse(model, layout, agents + bodies + doors, _static_geoms(model, house))


def _static_geoms(model: Any, house: CompiledHouse) -> dict[str, int]:
    """Map names of static geoms to indices of the house's static boxes: `static<c>` to c, pieces to a box.

    A convex piece `piece<instance>_<n>` maps to the first box of its object, which must have one. Pieces of movable
    objects, and geoms of other names or without a name, are left out.
    """
    found = {}
    for name in filter(None, (model.geom(geom).name for geom in range(model.ngeom))):
        kind, number = name.rstrip("0123456789_"), name.lstrip("abcdefghijklmnopqrstuvwxyz").split("_")[0]
        if kind == "static":
            found[name] = int(number)
        elif kind == "piece" and house.instances.body[int(number)] < 0:
            owner = house.instances.object_id[int(number)]
            found[name] = int(np.flatnonzero(house.colliders.object_id == owner)[0])
    return found


def _with_model_poses(physics: Physics, layout: Layout, houses: Sequence[MujocoHouse]) -> Physics:
    """Return the physics arrays with movable bodies at their poses in `qpos0` of the houses' MuJoCo models.

    There is one model per house of the bank, in its order. Unused rows keep their poses. Doors and arrangements are
    not adapted; `physics` itself is unchanged.
    """
    poses = np.concatenate([physics.body_pos, physics.body_quat], axis=-1)
    for row, house in zip(poses, houses, strict=True):
        qpos = np.zeros(layout.door_qpos.stop, np.float32)
        qpos[layout.body_qpos] = row.reshape(-1)
        row[:] = house.initial_poses(qpos)[layout.body_qpos].reshape(-1, 7)
    return physics.replace(body_pos=jnp.asarray(poses[..., :3]), body_quat=jnp.asarray(poses[..., 3:]))
