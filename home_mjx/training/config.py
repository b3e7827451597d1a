"""Options of training."""

from dataclasses import dataclass, field, fields, replace

from home_mjx.core.checks import check_flag, check_known, check_number, check_type
from home_mjx.errors import ConfigError
from home_mjx.registry import EnvSpec
from home_mjx.training.networks.agent import NetworkConfig

ALGORITHMS = ("ppo", "advised", "clone")
OPTIMIZERS = ("adam", "lamb")
FINAL_OBS = ("cheap", "all")
WHOLE = ("num_envs", "num_timesteps", "unroll_length", "num_minibatches", "num_epochs")
MOST_STEPS = 2**31 - 1  # they are counted in 32 bits
LEAST_SECONDS = 1e-3
PARTS = ("discount", "gae_lambda", "final_rate")


@dataclass(frozen=True)
class PPOConfig:
    """Options of `PPO`.

    The defaults are for one large GPU and images: they are what PointNav was learned with from depth (see the page on
    training). `CPU_CONFIG` is for two cores and vectors.

    Attributes:
        num_envs: Environments, over all devices.
        num_timesteps: Environment steps of the whole training; the learning rate falls until then.
        unroll_length: Steps of each environment between two updates; gradients go back through time as far.
        num_minibatches: Parts of a batch, each of whole environments.
        num_epochs: How often a batch is gone through.
        optimizer: "lamb" (arXiv:1904.00962), for large batches, or "adam", both with `weight_decay`.
        learning_rate: At the start.
        final_rate: Part of `learning_rate` that is left at the end; it falls linearly.
        weight_decay: As of AdamW (arXiv:1711.05101).
        max_grad_norm: Gradients are scaled down to this norm.
        discount: Per step.
        gae_lambda: Of generalised advantage estimation (arXiv:1506.02438).
        clip_range: How far the ratio of probabilities counts, from 1.
        entropy_cost: Weight of the entropy bonus.
        value_cost: Weight of the value's loss.
        advice_cost: Of algorithm "advised": weight of an expert's advice at the start, see `Advised`.
        stagger: Environments begin somewhere in the time of their first episode, so that they do not end all at once.
        final_obs: What an episode that runs out of time is continued by in the returns. "cheap": the value of the last
            observation if it needs no rays, else the value of the step before. "all": the value of the last
            observation, rendered for that.
        network: Sizes.

    Raises:
        ConfigError: A value cannot be used.

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
    stagger: bool = True
    final_obs: str = "cheap"
    network: NetworkConfig = field(default_factory=lambda: NetworkConfig(dtype="bfloat16"))

    def __post_init__(self) -> None:
        check_known("optimizer", [self.optimizer], OPTIMIZERS)
        check_known("choice of `final_obs`", [self.final_obs], FINAL_OBS)
        check_flag("stagger", self.stagger)
        check_type("network", self.network, NetworkConfig)
        for option in fields(self):
            value = getattr(self, option.name)
            if option.name in WHOLE:
                check_number(option.name, value, 1, whole=True)
            elif option.name in PARTS:
                check_number(option.name, value, 0, 1)
            elif isinstance(option.default, float):
                check_number(option.name, value, 0)
        steps = self.num_updates * self.num_epochs * self.num_minibatches
        if steps > MOST_STEPS:
            message = f"`num_timesteps` of {self.num_timesteps} make {steps} gradient steps, at most {MOST_STEPS}"
            raise ConfigError(message, hint="Take fewer, or larger batches: `num_envs`, `unroll_length`.")

    @property
    def batch_size(self) -> int:
        """Environment steps of an update."""
        return self.num_envs * self.unroll_length

    @property
    def num_updates(self) -> int:
        """Updates of the whole training."""
        return -(-self.num_timesteps // self.batch_size)

    def check_devices(self, num_devices: int, num_agents: int = 1) -> None:
        """Refuses numbers that do not divide.

        Raises:
            ConfigError: Environments cannot be dealt out evenly to devices, or their agents to minibatches.
        """
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
    """All that a training run is made of.

    Attributes:
        env: What `make` was asked for: task, houses, sensors.
        ppo: Options of the training.
        seed: Of everything random.
        algorithm: "ppo"; "clone": an expert's advice alone, see `Cloning`; "advised": both, see `Advised`.
        start: Checkpoint whose network is where training begins; None: a fresh one.
        clone_timesteps: So many environment steps of an expert's advice come before PPO's own.
        max_seconds: Training ends after so many seconds, if it has not by then, but not before its first update;
            compiling does not count. None: no limit. Learning rates fall as if there were none.

    Raises:
        ConfigError: A value cannot be used.
    """

    env: EnvSpec
    ppo: PPOConfig = field(default_factory=PPOConfig)
    seed: int = 0
    algorithm: str = "ppo"
    start: str | None = None
    clone_timesteps: int = 0
    max_seconds: float | None = None

    def __post_init__(self) -> None:
        check_known("algorithm", [self.algorithm], ALGORITHMS)
        check_type("env", self.env, EnvSpec)
        check_type("ppo", self.ppo, PPOConfig)
        check_number("seed", self.seed, 0, 2**32 - 1, whole=True)
        check_number("clone_timesteps", self.clone_timesteps, 0, whole=True)
        if self.max_seconds is not None:
            check_number("max_seconds", self.max_seconds, LEAST_SECONDS)
        if self.start is not None:
            check_type("start", self.start, str)
        if self.clone_timesteps and self.algorithm == "clone":
            raise ConfigError("`clone_timesteps` come before PPO; `algorithm` is clone", hint="Leave one of them out.")
        self.stages  # noqa: B018 - refuses options of any

    @property
    def stages(self) -> tuple[tuple[str, PPOConfig], ...]:
        """Algorithms and their options, one after the other.

        Example:
            >>> run = RunConfig(spec, PPOConfig(num_envs=64), clone_timesteps=10_000)  # doctest: +SKIP
            >>> [algorithm for algorithm, _ in run.stages]  # doctest: +SKIP
            ['clone', 'ppo']
        """
        own = ((self.algorithm, self.ppo),)
        if not self.clone_timesteps:
            return own
        return (("clone", replace(self.ppo, num_timesteps=self.clone_timesteps)), *own)
