"""Options of the physics."""

import math
from dataclasses import dataclass, field

from home_mjx.core.checks import check_number, check_type
from home_mjx.errors import ConfigError
from home_mjx.schema.agent import Body
from home_mjx.schema.timing import Timing

IMPLS = ("fused", "jax", "kinematic")
WARP = ". MJX-Warp is not offered: its agents fall through the floor"
JACOBIANS = ("auto", "dense", "sparse")
WHOLE = (
    "num_agents", "iterations", "ls_iterations", "agent_slots", "body_slots", "max_geom_pairs", "max_contact_points"
)  # fmt: skip


@dataclass(frozen=True)
class PhysicsConfig:
    """Options of the physics; hashable, fixed when the step is compiled.

    Attributes:
        num_agents: Agents per environment.
        body: Size and mass of every agent.
        timing: Length of a physics step and of a control step.
        forward_speed: [m/s] at action 1.
        strafe_speed: [m/s] at action 1.
        turn_rate: [rad/s] at action 1.
        push_force: [N], largest force of an agent's motors, in any horizontal direction.
        response_time: [s], time constant with which an agent approaches its target velocity.
        friction: Sliding friction of everything except agents, whose contacts are frictionless; 0.4 is wood on wood.
        max_body_speed: [m/s], limit of movable bodies; a fall of 1.8 m reaches 6 m/s.
        max_body_spin: [rad/s], limit of movable bodies.
        iterations: Newton iterations per physics step.
        ls_iterations: Line-search iterations; all of them always run.
        agent_slots: Static boxes that an agent can touch at once.
        body_slots: Static boxes that a movable body can touch at once.
        max_geom_pairs: Pairs of one kind (box and box, capsule and box) that are tested at once, those nearest by
            bounding spheres; None: two per body or four per agent.
        max_contact_points: Contact points of agents, and of bodies, the deepest; None: six per body or eight per agent.
        jacobian: MuJoCo's option; "auto" is sparse on CPU, where it is a third faster, and dense elsewhere.
        impl: "fused": all physics steps of a step in one compiled function on CPUs and NVIDIA GPUs, MJX elsewhere; no
            gradients. "jax": MJX everywhere, with forward-mode gradients (`jax.jvp`); reverse mode needs
            `iterations=1`, as MJX's solver is a loop of unknown length. "kinematic": no dynamics; agents slide along
            what is in the way, and things stay where they are.

    Raises:
        ConfigError: A value cannot be used.

    Example:
        >>> PhysicsConfig(timing=Timing(sim_dt=0.05)).timing.substeps
        2
    """

    num_agents: int = 1
    body: Body = field(default_factory=Body)
    timing: Timing = field(default_factory=Timing)
    forward_speed: float = 1.0
    strafe_speed: float = 0.7
    turn_rate: float = 1.5708
    push_force: float = 300.0
    response_time: float = 0.1
    friction: float = 0.4
    max_body_speed: float = 6.0
    max_body_spin: float = 30.0
    iterations: int = 4
    ls_iterations: int = 4
    agent_slots: int = 8
    body_slots: int = 4
    max_geom_pairs: int | None = None
    max_contact_points: int | None = None
    jacobian: str = "auto"
    impl: str = "fused"

    def __post_init__(self) -> None:
        self._check_choices()
        self._check_numbers()
        check_type("body", self.body, Body)
        check_type("timing", self.timing, Timing)

    def _check_choices(self) -> None:
        for name, value, known in (("impl", self.impl, IMPLS), ("jacobian", self.jacobian, JACOBIANS)):
            if value not in known:
                hint = f"Known: {', '.join(known)}" + (WARP if value == "warp" else "")
                raise ConfigError(f"unknown {name} `{value}`", element=f"PhysicsConfig.{name}", hint=hint)

    def _check_numbers(self) -> None:
        for name, value in vars(self).items():
            if name in ("impl", "jacobian", "body", "timing") or (value is None and name.startswith("max_")):
                continue
            try:
                check_number(name, value, 1 if name in WHOLE else math.ulp(0), whole=name in WHOLE)
            except ConfigError:
                kind = "a whole number of at least 1" if name in WHOLE else "a positive number"
                raise ConfigError(
                    f"expected {kind}, got {value!r}",
                    element=f"PhysicsConfig.{name}",
                    hint="Leave it out to get the default",
                ) from None
