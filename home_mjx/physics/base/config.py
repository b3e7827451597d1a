"""Options of the physics."""

import math
from dataclasses import dataclass, field, fields

from home_mjx.core.checks import check_flag, check_number, check_type
from home_mjx.errors import ConfigError
from home_mjx.schema.agent import AgentBody
from home_mjx.schema.timing import Timing

IMPLS = ("fused", "jax", "c", "kinematic")
WARP_HINT = ". MJX-Warp is not supported: agents fall through the floor"
JACOBIANS = ("auto", "dense", "sparse")
CONTROLS = ("velocity", "force")
MAX_AGENTS = 128  # maximum number of agents; arrays grow with the number of agent pairs
NON_NUMERIC_OPTIONS = (
    "impl", "jacobian", "control", "sleep", "restitution", "body", "bodies", "timing", "allow_sliding"
)  # fmt: skip
OPTIONAL_NUMBERS = ("friction", "max_geom_pairs", "max_contact_points")  # numbers that may be None
WHOLE_NUMBERS = (
    "num_agents", "iterations", "ls_iterations", "agent_slots", "body_slots", "max_geom_pairs", "max_contact_points"
)  # fmt: skip


@dataclass(frozen=True)
class PhysicsConfig:
    """Options of the physics; hashable, and constant in a compiled step.

    Body and time steps are not among them, because other engines share these; see `PhysicsSetup`.

    Attributes:
        num_agents: Agents per environment, at most 128.
        bodies: One `AgentBody` per agent if agents differ. Empty: all agents have the common `body`.
        control: "velocity": actions are fractions of an agent's maximum speeds, which its motors reach within
            `response_time`. "force": forward and left are fractions of its `max_push_force`, against a drag that
            balances it at maximum speed.
        response_time: [s], time constant of an agent's approach to its target velocity; in force control only of its
            yaw rate.
        friction: Sliding friction of all movable bodies; wood on wood is 0.4. None: by material. Agents are
            frictionless.
        restitution: Coefficient of restitution of all movable bodies, at most 0.9. None: by material.
        max_body_speed: [m/s], speed limit of movable bodies; a fall of 1.8 m reaches 6 m/s.
        max_body_spin: [rad/s], angular speed limit of movable bodies.
        iterations: Newton iterations per physics step, of MJX.
        ls_iterations: Line-search iterations of MJX; it always runs all of them.
        agent_slots: Maximum number of static boxes that an agent can touch at once, of MJX.
        body_slots: Maximum number of static boxes that a movable body can touch at once, of MJX.
        max_geom_pairs: Maximum number of geom pairs of one kind (box-box, capsule-box) that MJX tests, nearest bounding
            spheres first. None: two per body plus one per box of a door; at least four per agent, and 8.
        max_contact_points: Maximum number of contact points of agents, and of bodies, in MJX, deepest first. None: six
            per body; at least eight per agent, and 16.
        sleep: Whether the fused step skips bodies at rest until an awake body touches them.
        jacobian: MuJoCo's option, of MJX. "auto" is sparse on CPU, where it is a third faster, and dense elsewhere.
        impl: "fused": all physics steps of a control step in one compiled function on CPUs and NVIDIA GPUs, MJX
            elsewhere; no gradients. "jax": MJX everywhere, with forward-mode gradients (`jax.jvp`). Reverse mode needs
            `iterations=1`, since MJX's solver is a loop of unknown length. "c": C MuJoCo on each house's own model, on
            CPUs only; no gradients. "kinematic": no dynamics. Agents slide along obstacles, and bodies stay where they
            are.
        allow_sliding: Whether kinematic agents slide along obstacles; False: they stop at contact, as
            `allow_sliding=False` in Habitat. Others always slide, as contacts with agents have no friction.

    Raises:
        ConfigError: A value is invalid.

    Example:
        >>> PhysicsConfig(num_agents=2, friction=0.5).impl
        'fused'
    """

    num_agents: int = 1
    bodies: tuple[AgentBody, ...] = ()
    control: str = "velocity"
    response_time: float = 0.1
    friction: float | None = None
    restitution: float | None = None
    max_body_speed: float = 6.0
    max_body_spin: float = 30.0
    iterations: int = 6
    ls_iterations: int = 6
    agent_slots: int = 8
    body_slots: int = 4
    max_geom_pairs: int | None = None
    max_contact_points: int | None = None
    sleep: bool = True
    jacobian: str = "auto"
    impl: str = "fused"
    allow_sliding: bool = True

    def __post_init__(self) -> None:
        self._check_choices()
        self._check_numbers()
        check_number("num_agents", self.num_agents, 1, MAX_AGENTS, integer=True)
        if self.restitution is not None:
            check_number("restitution", self.restitution, 0, 0.9)
        check_flag("sleep", self.sleep)
        check_flag("allow_sliding", self.allow_sliding)
        if not self.allow_sliding and self.impl != "kinematic":
            message = f"`allow_sliding=False` needs kinematic movement, got impl `{self.impl}`"
            raise ConfigError(message, element="PhysicsConfig.allow_sliding", hint='Set `impl="kinematic"`.')
        self._check_bodies()

    def _check_bodies(self) -> None:
        """Raise `ConfigError` unless `bodies` is a tuple, not a list, of `AgentBody`, either empty or one per agent."""
        if not isinstance(self.bodies, tuple):
            raise ConfigError(f"`bodies` must be a tuple, got {self.bodies!r}", element="PhysicsConfig.bodies")
        for body in self.bodies:
            check_type("bodies", body, AgentBody)
        if self.bodies and len(self.bodies) != self.num_agents:
            raise ConfigError(
                f"there are {len(self.bodies)} bodies for {self.num_agents} agents",
                element="PhysicsConfig.bodies",
                hint="Give one body per agent, or omit `bodies` to use `body` for all agents.",
            )

    def _check_choices(self) -> None:
        """Raise `ConfigError` unless `impl`, `jacobian` and `control` are known values."""
        choices = {"impl": IMPLS, "jacobian": JACOBIANS, "control": CONTROLS}
        for name, known in choices.items():
            value = getattr(self, name)
            if value not in known:
                hint = f"Known: {', '.join(known)}" + (WARP_HINT if value == "warp" else "")
                raise ConfigError(f"unknown {name} `{value}`", element=f"PhysicsConfig.{name}", hint=hint)

    def _check_numbers(self) -> None:
        """Raise `ConfigError` unless all numbers are positive and finite; booleans are not numbers.

        `WHOLE_NUMBERS` must be integers, and `OPTIONAL_NUMBERS` may be None. `NON_NUMERIC_OPTIONS`, among them
        `restitution`, and the maximum of `num_agents` are not checked here.
        """
        for name, value in vars(self).items():
            if name in NON_NUMERIC_OPTIONS or (value is None and name in OPTIONAL_NUMBERS):
                continue
            try:
                check_number(name, value, 1 if name in WHOLE_NUMBERS else math.ulp(0), integer=name in WHOLE_NUMBERS)
            except ConfigError:
                kind = "a whole number of at least 1" if name in WHOLE_NUMBERS else "a positive number"
                raise ConfigError(
                    f"expected {kind}, got {value!r}",
                    element=f"PhysicsConfig.{name}",
                    hint="Omit it to use the default",
                ) from None


@dataclass(frozen=True)
class PhysicsSetup(PhysicsConfig):
    """Options of the physics with the records that it shares with other engines, as a `Template` holds them.

    In an environment body and timing are those of `EnvConfig`, which takes a `PhysicsConfig`.

    Attributes:
        body: Size, mass, strength and speeds of all agents; ignored with `bodies`.
        timing: Length of a physics step and of a control step.

    Raises:
        ConfigError: A value is invalid.

    Example:
        >>> PhysicsSetup(timing=Timing(sim_dt=0.05)).timing.substeps
        2
    """

    body: AgentBody = field(default_factory=AgentBody)
    timing: Timing = field(default_factory=Timing)

    def __post_init__(self) -> None:
        super().__post_init__()
        check_type("body", self.body, AgentBody)
        check_type("timing", self.timing, Timing)

    @classmethod
    def compose(cls, config: PhysicsConfig, body: AgentBody, timing: Timing) -> "PhysicsSetup":
        """Return a setup with the options of `config` and the given body and timing, which replace those of a setup.

        `bodies` of `config` are kept; unless they are empty, `body` has no effect.

        Example:
            >>> PhysicsSetup.compose(PhysicsConfig(friction=0.5), AgentBody(), Timing()).friction
            0.5
        """
        options = {option.name: getattr(config, option.name) for option in fields(PhysicsConfig)}
        return cls(**options, body=body, timing=timing)

    @property
    def agents(self) -> tuple[AgentBody, ...]:
        """Body of each agent: `bodies` unless it is empty, else the common `body` `num_agents` times.

        Example:
            >>> len(PhysicsSetup(num_agents=2).agents)
            2
        """
        return self.bodies or (self.body,) * self.num_agents
