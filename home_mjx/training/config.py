"""Options of training."""

from dataclasses import dataclass, field, fields, replace

from home_mjx.core.checks import check_flag, check_known, check_number, check_type
from home_mjx.errors import ConfigError
from home_mjx.registry import EnvSpec
from home_mjx.training.networks.agent import NetworkConfig

ALGORITHMS = ("ppo", "advised", "clone")
OPTIMIZERS = ("adam", "lamb")
FINAL_OBS = ("cheap", "all")
AUXILIARY = ("none", "source")
INTEGER_OPTIONS = ("num_envs", "num_timesteps", "unroll_length", "num_minibatches", "num_epochs")
MAX_GRADIENT_STEPS = 2**31 - 1  # maximum number of gradient steps; they are counted in 32 bits
MIN_SECONDS = 1e-3
FRACTION_OPTIONS = ("discount", "gae_lambda", "final_rate", "curriculum")


@dataclass(frozen=True)
class PPOConfig:
    """Options of `PPO`.

    The defaults are for one large GPU and images: PointNav from depth was learned with them (see the page on training).
    `CPU_CONFIG` is for two cores and vectors.

    Attributes:
        num_envs: Number of environments, over all devices.
        num_timesteps: Environment steps of the whole training, over which the learning rate falls.
        unroll_length: Steps of each environment between two updates, and of backpropagation through time.
        num_minibatches: Number of minibatches of a batch, each of whole environments.
        num_epochs: Number of passes over a batch.
        optimizer: "lamb" (arXiv:1904.00962), for large batches, or "adam", both with `weight_decay`.
        learning_rate: Learning rate at the start.
        final_rate: Fraction of `learning_rate` at the end of the linear schedule.
        weight_decay: Decoupled weight decay, as in AdamW (arXiv:1711.05101).
        max_grad_norm: Maximum global norm of gradients; larger ones are scaled down.
        discount: Discount per step.
        gae_lambda: λ of generalised advantage estimation (arXiv:1506.02438).
        clip_range: Maximum deviation of the probability ratio from 1 that counts.
        entropy_cost: Weight of the entropy bonus.
        value_cost: Weight of the value loss.
        advice_cost: Initial weight of an expert's advice with algorithm "advised", see `AdvisedPPO`.
        auxiliary: Further loss. "source": predict direction and distance of the first sound source from the memory,
            see `source_loss`. "none": none.
        auxiliary_cost: Weight of that loss.
        curriculum: Fraction of the updates over which the drawn rows grow from the easiest fifth to all, by path length
            and clutter, see `curriculum.row_difficulty`. 0: all rows from the start. For tasks with rows.
        stagger: Start environments at random times of their first episode, so that they do not all end at once.
        final_obs: Bootstrap of returns after an episode that runs out of time. "cheap": the value of the last
            observation if it needs no rays, else the value of the step before. "all": the value of the last
            observation, which is rendered for this purpose.
        network: Sizes of the network.

    Raises:
        ConfigError: A value is invalid.

    Example:
        >>> PPOConfig(num_envs=64, unroll_length=32, num_timesteps=100_000).num_updates
        49
    """

    num_envs: int = 2048
    num_timesteps: int = 50_000_000
    unroll_length: int = 32
    num_minibatches: int = 4
    num_epochs: int = 2
    optimizer: str = "adam"
    learning_rate: float = 5e-4
    final_rate: float = 0.1
    weight_decay: float = 0.0
    max_grad_norm: float = 1.0
    discount: float = 0.99
    gae_lambda: float = 0.95
    clip_range: float = 0.2
    entropy_cost: float = 0.01
    value_cost: float = 0.5
    advice_cost: float = 0.5
    auxiliary: str = "none"
    auxiliary_cost: float = 0.1
    curriculum: float = 0.0
    stagger: bool = True
    final_obs: str = "cheap"
    network: NetworkConfig = field(default_factory=lambda: NetworkConfig(dtype="bfloat16"))

    def __post_init__(self) -> None:
        check_known("optimizer", [self.optimizer], OPTIMIZERS)
        check_known("choice of `final_obs`", [self.final_obs], FINAL_OBS)
        check_known("auxiliary loss", [self.auxiliary], AUXILIARY)
        check_flag("stagger", self.stagger)
        check_type("network", self.network, NetworkConfig)
        for option in fields(self):
            value = getattr(self, option.name)
            if option.name in INTEGER_OPTIONS:
                check_number(option.name, value, 1, integer=True)
            elif option.name in FRACTION_OPTIONS:
                check_number(option.name, value, 0, 1)
            elif isinstance(option.default, float):
                check_number(option.name, value, 0)
        steps = self.num_updates * self.num_epochs * self.num_minibatches
        if steps > MAX_GRADIENT_STEPS:
            message = f"{self.num_timesteps} timesteps need {steps} gradient steps, the maximum is {MAX_GRADIENT_STEPS}"
            raise ConfigError(
                message, hint="Reduce `num_timesteps`, or use larger batches: `num_envs`, `unroll_length`."
            )

    @property
    def batch_size(self) -> int:
        """Environment steps of one update."""
        return self.num_envs * self.unroll_length

    @property
    def num_updates(self) -> int:
        """Number of updates of the whole training, rounded up."""
        return -(-self.num_timesteps // self.batch_size)

    def check_devices(self, num_devices: int, num_agents: int = 1) -> None:
        """Raise `ConfigError` unless devices divide `num_envs`, and `num_minibatches` divides the agents per device."""
        if self.num_envs % num_devices:
            message = f"`num_envs` must be a multiple of the {num_devices} devices, got {self.num_envs}"
            raise ConfigError(message, hint="Or train on fewer: PPO(..., devices=jax.devices()[:1]).")
        rows = self.num_envs // num_devices * num_agents
        if rows % self.num_minibatches:
            hint = f"`num_envs` per device times agents is {rows}."
            raise ConfigError(f"`num_minibatches` must divide {rows}, got {self.num_minibatches}", hint=hint)


CPU_CONFIG = PPOConfig(
    num_envs=64,
    num_timesteps=1_000_000,
    unroll_length=32,
    num_minibatches=4,
    num_epochs=4,
    optimizer="adam",
    learning_rate=5e-4,
    weight_decay=0.0,
    max_grad_norm=0.5,
    entropy_cost=1e-3,
    network=NetworkConfig(features=128, memory=128, channels=(16, 32, 64)),
)


@dataclass(frozen=True)
class RunConfig:
    """Complete configuration of a training run.

    Attributes:
        env: Spec of the environment: task, houses, sensors.
        ppo: Options of the training.
        seed: Seed of all random numbers.
        algorithm: "ppo"; "clone": an expert's advice alone, see `BehaviorCloning`; "advised": both, see `AdvisedPPO`.
        start: Checkpoint whose network training starts from; None: a fresh one.
        clone_timesteps: Environment steps of cloning before PPO; 0: none.
        max_seconds: Time limit of training without compilation, checked after each update; learning rates do not depend
            on it. None: no limit.
        validation_houses: Number of held-out houses that are played during training, see `HeldOutRollout`; 0: none.

    Raises:
        ConfigError: A value is invalid.
    """

    env: EnvSpec
    ppo: PPOConfig = field(default_factory=PPOConfig)
    seed: int = 0
    algorithm: str = "ppo"
    start: str | None = None
    clone_timesteps: int = 0
    max_seconds: float | None = None
    validation_houses: int = 0

    def __post_init__(self) -> None:
        check_known("algorithm", [self.algorithm], ALGORITHMS)
        check_type("env", self.env, EnvSpec)
        check_type("ppo", self.ppo, PPOConfig)
        check_number("seed", self.seed, 0, 2**32 - 1, integer=True)
        check_number("clone_timesteps", self.clone_timesteps, 0, integer=True)
        check_number("validation_houses", self.validation_houses, 0, integer=True)
        if self.max_seconds is not None:
            check_number("max_seconds", self.max_seconds, MIN_SECONDS)
        if self.start is not None:
            check_type("start", self.start, str)
        if self.clone_timesteps and self.algorithm == "clone":
            raise ConfigError("`clone_timesteps` precede PPO, but `algorithm` is clone", hint="Leave one of them out.")
        self.stages  # noqa: B018 - validates the options of every stage

    @property
    def stages(self) -> tuple[tuple[str, PPOConfig], ...]:
        """Algorithms and their options, in order: "clone" first if there are `clone_timesteps`, then `algorithm`.

        Example:
            >>> run = RunConfig(spec, PPOConfig(num_envs=64), clone_timesteps=10_000)  # doctest: +SKIP
            >>> [algorithm for algorithm, _ in run.stages]  # doctest: +SKIP
            ['clone', 'ppo']
        """
        own = ((self.algorithm, self.ppo),)
        if not self.clone_timesteps:
            return own
        return (("clone", replace(self.ppo, num_timesteps=self.clone_timesteps)), *own)
