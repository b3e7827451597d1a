"""The template with a house's numbers equals a host compile of that house, field by field."""

import dataclasses
import re

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest
from mujoco import mjx
from numpy.testing import assert_allclose
from tiny_houses import NUM_DOORS, Box, Door, TinyHouse, make_bank

from home_mjx.physics.base.config import PhysicsConfig, PhysicsSetup
from home_mjx.physics.dynamics import reset
from home_mjx.physics.mjx.house_model import (
    house_doors,
    house_model,
    house_surfaces,
    movable_bodies,
    with_doors,
    with_slots,
    with_surfaces,
)
from home_mjx.physics.mjx.mjx_step import fill_contact_slots, padded_static_boxes
from home_mjx.physics.mjx.template import Template
from home_mjx.physics.mjx.template_mjcf import CORNER_RADIUS, slot_names, template_mjcf
from home_mjx.schema import AgentBody, Timing
from home_mjx.schema.contact_materials import damping_ratio
from home_mjx.schema.mjcf import DOOR_DAMPING_RATE, contact_parameters

HOUSE = TinyHouse(
    floor=0.4,
    static=[Box((0.2, 0.2, 1.0), (0.05, 2.0, 0.6), yaw=0.1), Box((0.0, 0.6, 0.8), (0.45, 0.48, 0.4))],
    movable=[
        Box((0.5, 0.1, 0.7), (0.2, 0.15, 0.3), yaw=0.4, mass=7.5, friction=0.2, restitution=0.6),
        Box((-1.0, 0.6, 0.5), (0.4, 0.5, 0.1), roll=0.2, mass=100, friction=0.7, restitution=0.1),
        Box((-1.5, -1.0, 1.3), (0.3, 0.25, 0.9), mass=200),
    ],
    doors=[
        Door((0.4, 0.5), yaw=0.7, low=-0.2, high=1.4, mass=17),
        Door((-1.4, 1.5), yaw=-0.4, high=0.7, mass=25, slides=True),
    ],
)


def host_spec(template, house, slots=None):
    """A house for MuJoCo's own compiler: the template's MJCF with its numbers written in."""
    spec = mujoco.MjSpec.from_string(template_mjcf(template.config, template.layout, "sparse"))
    spec.geom("floor").pos = [0, 0, house.floor]
    for k, box in enumerate(house.movable):
        body = spec.body(f"body{k}")
        body.pos, body.quat, body.mass, body.inertia = box.pos, box.quat, box.mass, box.inertia
        spec.geom(f"body{k}").size = box.size
        for c in range(8):
            corner = spec.geom(f"body{k}_corner{c}")
            corner.pos = np.sign(corner.pos) * (np.array(box.size) - CORNER_RADIUS)
    for pair in spec.pairs:
        _set_contact(pair, house.movable, template.config.timing.sim_dt)
    for h, door in zip(house.door_rows, house.doors, strict=True):
        body, geom = spec.body(f"door{h}"), spec.geom(f"door{h}")
        origin = [*door.origin, door.pos[2]]
        arm = door.pos - origin
        x, y, z = np.square(door.size)
        body.pos, body.ipos, geom.pos = origin, arm, arm
        body.iquat, geom.quat, geom.size = door.quat, door.quat, door.size
        body.mass, body.inertia = door.mass, door.mass / 3 * np.array([y + z, x + z, x + y])
        joint, moved = spec.joint(f"door{h}"), body.inertia[2] + door.mass * arm @ arm
        joint.axis = [*door.axis, not door.slides]
        joint.range = [door.low, door.high]
        joint.damping = [DOOR_DAMPING_RATE * (door.mass if door.slides else moved), 0, 0]
    for i, name in enumerate(slot_names(template.layout) if slots is not None else []):
        geom = spec.geom(name)
        geom.pos, geom.quat, geom.size = (np.asarray(x[i], float) for x in (slots.pos, slots.quat, slots.half))
    return spec


def _set_contact(pair, bodies, timestep):
    """MuJoCo's rules for what two geoms have of their own, as far as bodies have priority; agents are left alone."""
    names = (pair.geomname1, pair.geomname2)
    if any(name.startswith("agent") for name in names):
        return
    rows = [int(found[1]) for name in names if (found := re.fullmatch(r"body(\d+)(_corner\d)?", name))]
    own = [bodies[row] if row < len(bodies) else Box((0, 0, 0), (0, 0, 0)) for row in rows]
    pair.friction[:2] = max(b.friction for b in own)
    found = [contact_parameters(np.array(damping_ratio(b.restitution)), timestep) for b in own]
    pair.solref = -np.max(found, axis=0)[:2]
    pair.solimp[[0, 2]] = np.mean(found, axis=0)[2:]


@pytest.fixture(scope="module")
def models():
    """The device's model of the second house of a bank, and the host's of the same."""
    bank = make_bank([TinyHouse(), HOUSE])
    template = Template(PhysicsConfig(jacobian="sparse"), bank.spec)
    house = jnp.int32(1)

    @jax.jit
    def build(bank, house):
        state = reset(template, bank, house, jnp.array([[0.0, 0.0, 0.4]]), jnp.zeros(1))
        data = template.data.replace(qpos=state.qpos)
        bodies = movable_bodies(bank.physics, house)
        slots, _, _ = fill_contact_slots(
            template, padded_static_boxes(template, bank.physics, house), bodies.size, data
        )
        model = house_model(template.model, template.layout, bodies, bank.physics.floor[house])
        model = with_doors(model, template.layout, house_doors(bank.physics, house))
        surfaces = house_surfaces(template.config, bank.physics, house)
        model = with_surfaces(model, template.layout, template.pair_bodies, surfaces)
        return with_slots(model, template.layout, slots), slots

    with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
        model, slots = build(bank, house)
    assert (np.asarray(slots.pos)[:, 2] > -1).sum() >= 3  # filled, so they count below
    return model, mjx.put_model(host_spec(template, HOUSE, slots).compile(), impl="jax"), template.model


def _arrays(model):
    fields = {f.name: getattr(model, f.name) for f in dataclasses.fields(model)}
    return {n: np.asarray(v) for n, v in fields.items() if isinstance(v, jax.Array | np.ndarray) and v.dtype != object}


def test_every_field_equals_the_host_compile(models):
    device, host, _ = map(_arrays, models)
    assert device.keys() == host.keys()
    # Marks geoms that share their body's frame for short cuts; the template must claim none that a house breaks.
    flags = device.pop("geom_sameframe"), host.pop("geom_sameframe")
    assert ((flags[0] == flags[1]) | (flags[0] == mujoco.mjtSameFrame.mjSAMEFRAME_NONE)).all()
    for name, want in host.items():
        assert_allclose(device[name], want, rtol=2e-6, atol=1e-6, err_msg=name)


def test_house_differs_from_the_template_in_derived_fields(models):
    # Guards the test above: were these equal in the template, it would prove nothing about them.
    _, host, template = map(_arrays, models)
    for name in ("body_invweight0", "dof_invweight0", "body_subtreemass", "dof_M0", "geom_rbound", "geom_aabb"):
        assert not np.allclose(host[name], template[name]), name


def test_template_is_stepped_with_the_options_asked_for():
    bank = make_bank([TinyHouse()])
    config = PhysicsSetup(
        num_agents=2, iterations=3, ls_iterations=7, timing=Timing(sim_dt=0.01), agent_slots=5, body_slots=3
    )
    model = Template(config, bank.spec).model
    assert (model.opt.iterations, model.opt.ls_iterations) == (3, 7)
    assert_allclose(model.opt.timestep, 0.01)
    assert (model.nq, model.nv, model.nu) == (2 * 4 + 4 * 7 + NUM_DOORS, 2 * 4 + 4 * 6 + NUM_DOORS, 6)
    assert model.ngeom == 1 + 2 * 5 + 4 * 3 + 2 * 2 + 4 * 9 + NUM_DOORS


def test_agents_weigh_what_was_asked_for():
    config = PhysicsSetup(body=AgentBody(mass=72.0, radius=0.2, height=1.7))
    model = Template(config, make_bank([TinyHouse()]).spec).model
    assert_allclose(model.body_mass[1], 72.0)
    # Yaw inertia of a capsule: cylinder m r^2 / 2 and two half balls 2/5 m r^2, shared by volume.
    cylinder, ball = 1.3 * 0.2**2, 4 / 3 * 0.2**3
    expected = 72 * 0.2**2 * (0.5 * cylinder + 0.4 * ball) / (cylinder + ball)
    assert_allclose(model.body_inertia[1, 2], expected, rtol=1e-4)
