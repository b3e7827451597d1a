"""The template and how it is stepped."""

import contextlib
from collections.abc import Iterator

import jax
import jax.numpy as jnp
import mujoco
from jaxtyping import Array, Bool, Float, Int
from mujoco import mjx

from home_mjx.bank.bank import HouseBank
from home_mjx.bank.records import BankSpec, Physics
from home_mjx.physics.config import PhysicsConfig
from home_mjx.physics.control import motor_forces
from home_mjx.physics.house_model import MovableBodies, house_model, movable_bodies, with_slots
from home_mjx.physics.layout import Layout
from home_mjx.physics.lost import Lost, Pairs, Sizes, are_points_full, limit
from home_mjx.physics.slots import FLAT, Boxes, fill, parked
from home_mjx.physics.template_mjcf import template_mjcf

# What a step of MuJoCo starts from; all else in `mjx.Data` is derived.
STATE = ("time", "qpos", "qvel", "qacc", "qacc_warmstart", "ctrl", "sensordata")


class Template:
    """The one model of a capacity; build it once, outside of any trace, and use it for all houses.

    Args:
        config: Options.
        spec: Capacities of the bank.

    Example:
        >>> from home_mjx.bank.records import BankSpec
        >>> spec = BankSpec(64, 8, 64, 64, 16, 4, 0.1, 0.1, 1.6)
        >>> Template(PhysicsConfig(), spec).model.nv
        52
    """

    def __init__(self, config: PhysicsConfig, spec: BankSpec) -> None:
        self.config = config
        self.layout = Layout(config.num_agents, spec.num_bodies, config.agent_slots, config.body_slots)
        xml = template_mjcf(config, self.layout, _jacobian(config))
        host = mujoco.MjModel.from_xml_string(xml)  # pyright: ignore[reportAttributeAccessIssue]
        self.yaw_inertia = float(host.dof_M0[3])
        self.model = mjx.put_model(host, impl=config.impl)
        self.pairs = Pairs.of(host)
        self.max_points = limit(host, "max_contact_points")
        self.data = mjx.make_data(self.model, impl=config.impl)


def reset(
    template: Template,
    bank: HouseBank,
    house: Int[Array, ""],
    agent_pos: Float[Array, "a 3"],
    agent_yaw: Float[Array, " a"],
) -> mjx.Data:
    """Agents and movable bodies at rest at their starting poses.

    Args:
        template: The model.
        bank: The houses.
        house: Index of the house.
        agent_pos: [m], feet on the floor.
        agent_yaw: [rad], counter-clockwise from +x.
    """
    bodies = movable_bodies(bank.physics, house)
    rise = jnp.array([0.0, 0.0, template.config.body.height / 2], jnp.float32)
    agents = jnp.concatenate([agent_pos + rise[None], agent_yaw[:, None]], axis=-1)
    qpos = jnp.concatenate([agents.reshape(-1), jnp.concatenate([bodies.pos, bodies.quat], axis=-1).reshape(-1)])
    return template.data.replace(qpos=qpos)


def step(
    template: Template, bank: HouseBank, house: Int[Array, ""], data: mjx.Data, action: Float[Array, "a 3"]
) -> mjx.Data:
    """One control step: `config.timing.substeps` physics steps.

    Args:
        template: The model.
        bank: The houses.
        house: Index of the house.
        data: The state before.
        action: Forward, strafe to the left, turn to the left in the agent's own frame, in [-1, 1] of its fastest rate.

    Returns:
        The state after. Its `sensordata` counts each agent's contact points with anything but the floor, the most of
        all physics steps.
    """
    return step_checked(template, bank, house, data, action)[0]


def step_checked(
    template: Template, bank: HouseBank, house: Int[Array, ""], data: mjx.Data, action: Float[Array, "a 3"]
) -> tuple[mjx.Data, Lost]:
    """`step`, and what it left out because it did not fit: of contacts, in the last physics step."""
    bodies = movable_bodies(bank.physics, house)
    static = static_boxes(template, bank.physics, house)
    model = house_model(template.model, template.layout, bodies, bank.physics.floor[house])

    def substep(carry: tuple[mjx.Data, Sizes], _: None) -> tuple[tuple[mjx.Data, Sizes], tuple[Array, Array]]:
        data = carry[0]
        data = data.replace(ctrl=_control(template, data, action))
        slots, crowded = nearest_boxes(template, static, bodies.size, data)
        filled = with_slots(model, template.layout, slots)
        with _as_mjx_needs():
            data = mjx.step(filled, data)
        sizes = Sizes(size=filled.geom_size, rbound=filled.geom_rbound)
        return (_settle_bodies(template, bodies, data), sizes), (data.sensordata, crowded)

    first = data, Sizes(size=model.geom_size, rbound=model.geom_rbound)
    (data, sizes), (contacts, crowded) = jax.lax.scan(substep, first, None, length=template.config.timing.substeps)
    lost = Lost(
        static_boxes=jnp.any(crowded),
        contact_pairs=template.pairs.lost(sizes, data),
        contact_points=are_points_full(data, template.max_points),
    )
    return data.replace(sensordata=contacts.max(axis=0)), lost


def undo_where(broken: Bool[Array, ""], data: mjx.Data, before: mjx.Data) -> mjx.Data:
    """The state before a step where the step has broken it.

    What MuJoCo derives from poses and speeds stays as it is: the next step computes it anew.
    """
    fields = {name: (getattr(data, name), getattr(before, name)) for name in STATE}
    return data.replace(**{name: jnp.where(broken, old, new) for name, (new, old) in fields.items()})


def is_broken(data: mjx.Data) -> Bool[Array, ""]:
    """Whether a pose or a speed is not a finite number."""
    return ~(jnp.all(jnp.isfinite(data.qpos)) & jnp.all(jnp.isfinite(data.qvel)))


def static_boxes(template: Template, physics: Physics, house: Int[Array, ""]) -> Boxes:
    """The static boxes of a house that rise above its floor, and enough parked ones to fill all slots of an owner.

    What lies in or flat on the floor is parked, too: the floor plane is there already, and an agent that stands on a
    rug touches "nothing but the floor".
    """
    own = Boxes(physics.collider_pos[house], physics.collider_quat[house], physics.collider_size[house])
    above = own.top > physics.floor[house] + jnp.float32(FLAT)
    own = jax.tree.map(lambda x, y: jnp.where(above[:, None], x, y), own, parked(above.shape[0]))
    missing = max(template.config.agent_slots, template.config.body_slots) - above.shape[0]
    return jax.tree.map(lambda x, y: jnp.concatenate([x, y]), own, parked(missing)) if missing > 0 else own


def nearest_boxes(
    template: Template, static: Boxes, body_size: Float[Array, "k 3"], data: mjx.Data
) -> tuple[Boxes, Bool[Array, ""]]:
    """What the slots hold: the static boxes nearest to each agent and to each body; and whether some were left out.

    Left out are boxes that touch an owner whose slots are all taken by nearer ones.
    """
    config = template.config
    slots, crowded = [], jnp.zeros((), bool)
    for owners, num in (
        (_agent_boxes(template, data), config.agent_slots),
        (Boxes(*body_pose(template, data), body_size), config.body_slots),
    ):
        if owners.pos.shape[0]:
            filled, over = jax.vmap(lambda owner, num=num: fill(owner, static, num))(owners)
            crowded = crowded | jnp.any(over)
            slots.append(jax.tree.map(lambda x: x.reshape(-1, x.shape[-1]), filled))
    return jax.tree.map(lambda *x: jnp.concatenate(x), *slots), crowded


def agent_pose(template: Template, data: mjx.Data) -> tuple[Float[Array, "a 3"], Float[Array, " a"]]:
    """Centre of each agent's capsule [m] and its yaw [rad]."""
    agents = data.qpos[template.layout.agent_qpos].reshape(-1, 4)
    return agents[:, :3], agents[:, 3]


def agent_velocity(template: Template, data: mjx.Data) -> Float[Array, "a 3"]:
    """Each agent's velocity forward and to the left [m/s] and its yaw rate [rad/s]."""
    _, yaw = agent_pose(template, data)
    velocity = data.qvel[template.layout.agent_qpos].reshape(-1, 4)
    x, y = velocity[:, 0], velocity[:, 1]
    cos, sin = jnp.cos(yaw), jnp.sin(yaw)
    return jnp.stack([cos * x + sin * y, cos * y - sin * x, velocity[:, 3]], axis=-1)


def body_pose(template: Template, data: mjx.Data) -> tuple[Float[Array, "k 3"], Float[Array, "k 4"]]:
    """Centre [m] and orientation (wxyz) of each movable body; unused ones are parked high above the house."""
    bodies = data.qpos[template.layout.body_qpos].reshape(-1, 7)
    return bodies[:, :3], bodies[:, 3:]


def agent_contact(template: Template, data: mjx.Data) -> Bool[Array, " a"]:
    """Whether each agent touched anything but the floor during the last control step."""
    return data.sensordata[: template.layout.num_agents] > 0


def _control(template: Template, data: mjx.Data, action: Float[Array, "a 3"]) -> Float[Array, " u"]:
    _, yaw = agent_pose(template, data)
    velocity = data.qvel[template.layout.agent_qpos].reshape(-1, 4)
    forces = jax.vmap(lambda a, y, v: motor_forces(template.config, template.yaw_inertia, a, y, v))
    return forces(action, yaw, velocity).reshape(-1)


def _settle_bodies(template: Template, bodies: MovableBodies, data: mjx.Data) -> mjx.Data:
    """Puts unused bodies back to where they were and limits the speed of the others.

    Unused bodies are put back exactly, so they stay there however many steps pass. The limits keep a body that starts
    deep inside another from being shot through a wall, and from spinning so fast that explicit integration of its
    gyroscopic torque diverges (it does from about 1 rad per physics step on).
    """
    if not template.layout.num_bodies:
        return data
    at, dof = template.layout.body_qpos, template.layout.body_qvel
    parked = jnp.concatenate([bodies.pos, bodies.quat], axis=-1)
    used = bodies.valid[:, None]
    qpos = jnp.where(used, data.qpos[at].reshape(-1, 7), parked)
    qvel = data.qvel[dof].reshape(-1, 6)
    linear = _limit_length(qvel[:, :3], template.config.max_body_speed)
    spin = _limit_length(qvel[:, 3:], template.config.max_body_spin)
    qvel = jnp.where(used, jnp.concatenate([linear, spin], axis=-1), jnp.float32(0.0))
    return data.replace(qpos=data.qpos.at[at].set(qpos.reshape(-1)), qvel=data.qvel.at[dof].set(qvel.reshape(-1)))


def _limit_length(vectors: Float[Array, "k 3"], longest: float) -> Float[Array, "k 3"]:
    square = jnp.sum(vectors * vectors, axis=-1, keepdims=True)
    scale = jnp.float32(longest) * jax.lax.rsqrt(jnp.maximum(square, jnp.float32(longest**2)))
    return jnp.where(square > jnp.float32(longest**2), vectors * scale, vectors)


def _agent_boxes(template: Template, data: mjx.Data) -> Boxes:
    config = template.config
    pos, _ = agent_pose(template, data)
    body = config.body
    half = jnp.array([[body.radius, body.radius, body.height / 2]], jnp.float32)
    upright = jnp.array([[1.0, 0.0, 0.0, 0.0]], jnp.float32)
    return Boxes(pos, jnp.tile(upright, (config.num_agents, 1)), jnp.tile(half, (config.num_agents, 1)))


def _jacobian(config: PhysicsConfig) -> str:
    if config.jacobian != "auto":
        return config.jacobian
    return "sparse" if jax.default_backend() == "cpu" else "dense"


@contextlib.contextmanager
def _as_mjx_needs() -> Iterator[None]:
    """MJX mixes dtypes and ranks, which strict contexts refuse, and its solver needs more than a GPU's 10-bit TF32."""
    with (
        jax.numpy_dtype_promotion("standard"),
        jax.numpy_rank_promotion("allow"),
        jax.default_matmul_precision("highest"),
    ):
        yield
