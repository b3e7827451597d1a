"""The numbers of a template that every environment shares."""

from typing import NamedTuple

from home_mjx.physics.base.config import PhysicsConfig
from home_mjx.physics.reference.template_mjcf import CORNER_RADIUS
from home_mjx.scene_compile.mjcf.agent import AGENT_SOLREF, BODY_SOLREF

GRAVITY = 9.81  # [m/s^2], MuJoCo's default, as are the next three
IMPEDANCE_LOW, IMPEDANCE_HIGH, IMPEDANCE_WIDTH = 0.9, 0.95, 0.001
ITERATIONS = 50  # of Newton's method, which ends by itself: most physics steps take one to three


class Numbers(NamedTuple):
    """In [m], [kg], [s], [N] and their products; an array holds them in this order."""

    sim_dt: float
    substeps: float
    gravity: float
    radius: float  # of an agent's capsule
    length: float  # half of its axis
    agent_mass: float
    yaw_inertia: float
    forward_speed: float
    strafe_speed: float
    turn_rate: float
    push_force: float
    response_time: float
    friction: float
    max_body_speed: float
    max_body_spin: float
    agent_stiffness: float  # of contacts with agents: reference acceleration per depth and impedance
    agent_damping: float  # and per velocity
    body_stiffness: float
    body_damping: float
    impedance_low: float
    impedance_high: float
    impedance_width: float
    iterations: float
    corner_radius: float


def numbers_of(config: PhysicsConfig, yaw_inertia: float) -> Numbers:
    """The numbers of a template; its agents' inertia about the vertical axis is MuJoCo's."""
    body, timing = config.body, config.timing
    return Numbers(
        sim_dt=timing.sim_dt,
        substeps=timing.substeps,
        gravity=GRAVITY,
        radius=body.radius,
        length=body.half_length,
        agent_mass=body.mass,
        yaw_inertia=yaw_inertia,
        forward_speed=config.forward_speed,
        strafe_speed=config.strafe_speed,
        turn_rate=config.turn_rate,
        push_force=config.push_force,
        response_time=config.response_time,
        friction=config.friction,
        max_body_speed=config.max_body_speed,
        max_body_spin=config.max_body_spin,
        **_spring("agent", AGENT_SOLREF, timing.sim_dt),
        **_spring("body", BODY_SOLREF, timing.sim_dt),
        impedance_low=IMPEDANCE_LOW,
        impedance_high=IMPEDANCE_HIGH,
        impedance_width=IMPEDANCE_WIDTH,
        iterations=ITERATIONS,
        corner_radius=CORNER_RADIUS,
    )


def _spring(kind: str, solref: str, sim_dt: float) -> dict[str, float]:
    """MuJoCo's stiffness and damping of a `solref` (time constant and damping ratio); see "Solver parameters"."""
    constant, ratio = (float(x) for x in solref.split())
    constant = max(constant, 2 * sim_dt)
    stiffness = 1 / (IMPEDANCE_HIGH * constant * ratio) ** 2
    return {f"{kind}_stiffness": stiffness, f"{kind}_damping": 2 / (IMPEDANCE_HIGH * constant)}
