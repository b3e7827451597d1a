"""The agent: encoder, recurrent core, and heads for actions and value."""

import functools
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import flax.linen as nn
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from home_mjx.core.checks import check_flag, check_known, check_number
from home_mjx.errors import ConfigError
from home_mjx.tasks.base.specs import ArraySpec
from home_mjx.training.networks.distributions import Distribution, distribution_of
from home_mjx.training.networks.encoders import Encoder, kind_of

DTYPES = ("float32", "bfloat16")
INITIAL_LOG_SCALE = -0.5  # of continuous actions in [-1, 1]: a standard deviation of 0.6


@dataclass(frozen=True)
class NetworkConfig:
    """Sizes of an agent's network.

    Attributes:
        features: Of the encoder.
        memory: Numbers that the GRU keeps.
        channels: Of the blocks that read images.
        dtype: Type in which images are convolved: "float32" or "bfloat16". Everything else is float32.
        mentions: Mark in images of ids what instructions name, see `mentioned`, and look there, see `Glimpse`. Without,
            each word has to be learned.
        normalized: Scale the encoder's features before the memory reads them (layer normalisation, arXiv:1607.06450),
            and let actions and value be read from them, too, beside the memory. Without, features of many images grow
            until the memory's gates are all open or shut.

    Raises:
        ConfigError: A value cannot be used.
    """

    features: int = 256
    memory: int = 512
    channels: tuple[int, ...] = (32, 64, 128)
    dtype: str = "float32"
    mentions: bool = True
    normalized: bool = True

    def __post_init__(self) -> None:
        check_known("dtype", [self.dtype], DTYPES)
        check_flag("network.mentions", self.mentions)
        check_flag("network.normalized", self.normalized)
        for name, value in (("features", self.features), ("memory", self.memory)):
            check_number(f"network.{name}", value, 1, whole=True)
        if not isinstance(self.channels, tuple) or not self.channels:
            raise ConfigError(f"`network.channels` must be a tuple of numbers, got {self.channels!r}")
        for value in self.channels:
            check_number("network.channels", value, 1, whole=True)


class Memory(nn.Module):
    """A GRU over time (arXiv:1406.1078) that forgets where an episode begins."""

    features: int

    @functools.partial(nn.scan, variable_broadcast="params", split_rngs={"params": False})
    @nn.compact
    def __call__(self, memory: Array, inputs: tuple[Array, Array]) -> tuple[Array, Array]:
        """One step of all environments; `nn.scan` makes it a function of (T, N, ...) inputs."""
        x, begins = inputs
        return nn.GRUCell(self.features)(jnp.where(begins[:, None], 0.0, memory), x)


class RecurrentAgent(nn.Module):
    """A policy and a value that remember.

    Attributes:
        specs: Name and spec of every observation of one agent.
        distribution: Of actions.
        config: Sizes.

    Example:
        >>> agent = RecurrentAgent.of(core.observation_spec, core.action_spec)  # doctest: +SKIP
        >>> memory, params, value = agent.read(net, memory, obs, begins)  # doctest: +SKIP
    """

    specs: tuple[tuple[str, ArraySpec], ...]
    distribution: Any  # a `Distribution`
    config: NetworkConfig = field(default_factory=NetworkConfig)

    @classmethod
    def of(
        cls, observations: Mapping[str, ArraySpec], action: ArraySpec, config: NetworkConfig | None = None
    ) -> "RecurrentAgent":
        """The agent for observations and actions, both of one agent.

        Raises:
            ConfigError: It would observe nothing, or no distribution is known for its actions.
        """
        specs = tuple((name, spec) for name, spec in sorted(observations.items()) if kind_of(name, spec) != "none")
        if not specs:
            raise ConfigError("the agent would observe nothing", hint="Name sensors=, such as state, goal or depth.")
        return cls(specs, distribution_of(action), config or NetworkConfig())

    @nn.compact
    def __call__(
        self, memory: Float[Array, "n m"], obs: dict[str, Array], begins: Bool[Array, "t n"]
    ) -> tuple[Float[Array, "n m"], Float[Array, "t n p"], Float[Array, "t n"]]:
        """Reads T steps of N agents.

        Args:
            memory: Before the first step.
            obs: Observations (T, N, ...).
            begins: Where an episode's first observation is: the memory before it is forgotten.

        Returns:
            The memory after the last step, parameters of the distribution, and values.
        """
        dtype = jnp.dtype(self.config.dtype)
        sizes = self.config.features, self.config.channels
        seen = Encoder(self.specs, *sizes, dtype, self.config.mentions)(obs)
        seen = nn.LayerNorm()(seen) if self.config.normalized else seen
        memory, x = Memory(self.config.memory)(memory, (seen, begins))
        x = jnp.concatenate([x, seen], axis=-1) if self.config.normalized else x
        return memory, self._policy(x), self._value(x)

    def read(
        self, net: Any, memory: Float[Array, "n m"], obs: dict[str, Array], begins: Bool[Array, "t n"]
    ) -> tuple[Float[Array, "n m"], Float[Array, "t n p"], Float[Array, "t n"]]:
        """The network with its parameters `net`: memory after T steps, parameters of the distribution, values."""
        applied: Any = self.apply(net, memory, obs, begins)
        return applied

    def read_one(
        self, net: Any, memory: Float[Array, "n m"], obs: dict[str, Array], begins: Bool[Array, " n"]
    ) -> tuple[Float[Array, "n m"], Float[Array, "n p"], Float[Array, " n"]]:
        """`read` for a single step."""
        memory, params, value = self.read(net, memory, jax.tree.map(lambda x: x[None], obs), begins[None])
        return memory, params[0], value[0]

    def first_memory(self, num: int) -> Float[Array, "n m"]:
        """What `num` agents remember before their first step."""
        return jnp.zeros((num, self.config.memory), jnp.float32)

    def init_net(self, key: Array) -> Any:
        """Fresh parameters."""
        obs = {name: jnp.zeros((1, 1, *spec.shape), spec.dtype) for name, spec in self.specs}
        return jax.jit(self.init)(key, self.first_memory(1), obs, jnp.ones((1, 1), bool))

    def _policy(self, x: Array) -> Array:
        distribution: Distribution = self.distribution
        small = nn.initializers.orthogonal(0.01)  # all actions are about as likely at first
        outputs = nn.Dense(distribution.num_outputs, kernel_init=small, name="policy")(x)
        if not distribution.num_scales:
            return outputs
        scales = self.param("log_scale", nn.initializers.constant(INITIAL_LOG_SCALE), (distribution.num_scales,))
        return jnp.concatenate([outputs, jnp.broadcast_to(scales, (*x.shape[:-1], distribution.num_scales))], axis=-1)

    def _value(self, x: Array) -> Array:
        return nn.Dense(1, kernel_init=nn.initializers.orthogonal(1.0), name="value")(x)[..., 0]
