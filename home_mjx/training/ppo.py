"""Recurrent PPO in plain JAX: one compiled update of rollout, advantages and minibatches, on any number of devices.

Schulman et al., "Proximal Policy Optimization Algorithms", 2017 (arXiv:1707.06347).

Example:
    >>> env = home_mjx.make("PointNav-v0", sensors=("depth", "goal"))  # doctest: +SKIP
    >>> ppo = PPO(env.core, PPOConfig(num_envs=1024))  # doctest: +SKIP
    >>> state = ppo.init(env.params, jax.random.key(0))  # doctest: +SKIP
    >>> for _ in range(ppo.config.num_updates):  # doctest: +SKIP
    ...     state, metrics = ppo.update(env.params, state)
"""

from collections.abc import Callable, Sequence
from typing import Any

import jax
import jax.numpy as jnp
import optax
from jax.stages import Compiled, Lowered
from jaxtyping import Array, Float, Int, UInt32

from home_mjx.core.pytree import Pytree
from home_mjx.sharding import (
    BY_ENV,
    REPLICATED,
    EnvSharding,
    env_index,
    make_mesh,
    mean_over_devices,
    sum_over_devices,
)
from home_mjx.tasks.base.state import EnvParams, to_raw_key
from home_mjx.tasks.env.autoreset import AutoReset
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.env.reset import is_sequential
from home_mjx.tasks.sensors.interaural_cues import SOURCE_TARGET
from home_mjx.training.auxiliary import NUM_PREDICTIONS, TARGET_SENSORS, add_sensors, source_loss
from home_mjx.training.config import PPOConfig
from home_mjx.training.curriculum import scheduled_params
from home_mjx.training.early_warnings import dead_units
from home_mjx.training.networks.agent import RecurrentAgent
from home_mjx.training.rollout import Policy, RolloutState, Transitions, compute_advantages, rollout, to_rows

LossFunction = Callable[[Any, "TrainBatch"], tuple[Array, dict[str, Array]]]


class TrainState(Pytree):
    """Complete state of training; with the same houses it determines the next update bit by bit."""

    net: Any  # parameters
    opt: Any  # the optimizer's state
    actor: RolloutState
    key: UInt32[Array, "2"]
    updates: Int[Array, ""]  # updates of the run so far


class TrainBatch(Pytree):
    """Training data of one update: T steps of R rows."""

    steps: Transitions
    memory: Float[Array, "r m"]  # before the first step
    advantage: Float[Array, "t r"]
    target: Float[Array, "t r"]  # of the value


class PPO:
    """Recurrent PPO for one kind of environment.

    Several agents of an environment share one network and learn independently.

    Args:
        core: The environment's functions.
        config: Options.
        devices: Devices to train on; all of JAX's by default. Each gets an equal share of the environments.

    Attributes:
        agent: The network.
        config: The options.
        batch: The environments, with automatic resets.
        update: Compiled function from `(params, state)` to the next state and metrics. On several devices, `params`
            should first be put there: `ppo.sharding.put_params(params)`.
        sharding: Environments and parameters over the devices.
        first_update: Updates of the run before this learner's first one; schedules count from there.

    Raises:
        ConfigError: Batch sizes do not divide evenly, or the environment's observations or actions have no network.
    """

    def __init__(
        self, core: HouseholdEnv, config: PPOConfig | None = None, devices: Sequence[Any] | None = None
    ) -> None:
        self.config = config or PPOConfig()
        self.first_update = 0
        self.core = core = add_sensors(core, TARGET_SENSORS[self.config.auxiliary])
        devices = list(devices or jax.devices())
        self.config.check_devices(len(devices), core.num_agents)
        self.agent = make_agent(core, self.config)
        costly = {name for sensor in core.sensors if sensor.casts_rays for name in sensor.spec(core.config)}
        casts_rays = bool(costly & {name for name, _ in self.agent.specs})
        self._evaluates_last = self.config.final_obs == "all" or not casts_rays
        self.batch = AutoReset(core, final_obs=self.config.final_obs if casts_rays else "cheap")
        self.optimizer = make_optimizer(self.config)
        self.sharding = EnvSharding(make_mesh(devices))
        params = self.sharding.params
        self._specs = TrainState.build_unchecked(
            net=REPLICATED, opt=REPLICATED, actor=BY_ENV, key=REPLICATED, updates=REPLICATED
        )
        self._reset = self.sharding.map(self._reset_local, (params, BY_ENV), BY_ENV)
        self.update = self.sharding.map(self._update_local, (params, self._specs), (self._specs, REPLICATED))

    def lower(self, params: EnvParams) -> tuple[Lowered, Lowered]:
        """Trace the programs of `init` and `update` without computing anything, so that both compile at the same time.

        Example:
            >>> reset, update = ppo.lower(env.params)  # doctest: +SKIP
            >>> state = ppo.init(env.params, jax.random.key(0), reset.compile())  # doctest: +SKIP
            >>> state, metrics = update.compile()(env.params, state)  # doctest: +SKIP
        """
        keys = jax.ShapeDtypeStruct((self.config.num_envs, 2), jnp.uint32)
        state = jax.eval_shape(self.init, params, jax.random.key(0))
        reset = self._reset.lower(params, self.sharding.with_shardings(keys, BY_ENV))
        return reset, self.update.lower(params, self.sharding.with_shardings(state, self._specs))

    def init(self, params: EnvParams, key: Array, reset: Compiled | None = None) -> TrainState:
        """Return a state with fresh parameters and reset environments; `key` is typed or raw.

        With `stagger` their step counters are at random times of an episode, so that the first ones end early. `reset`
        is the first program of `lower`; None: it is compiled here.
        """
        net_key, env_key, own = jax.random.split(jax.random.wrap_key_data(to_raw_key(key)), 3)
        net = self.agent.init_net(net_key)
        keys = self.sharding.put_envs(jax.random.key_data(jax.random.split(env_key, self.config.num_envs)))
        actor = (reset or self._reset)(params, keys)
        return self.to_devices(TrainState(
            net=net, opt=self.optimizer.init(net), actor=actor, key=to_raw_key(own), updates=jnp.zeros((), jnp.int32)
        ))  # fmt: skip

    def to_devices(self, state: TrainState) -> TrainState:
        """Return a state, such as one from a file, on the devices with the sharding of `update`."""
        return self.sharding.put(state, self._specs)

    def _reset_local(self, params: EnvParams, keys: UInt32[Array, "n 2"]) -> RolloutState:
        """Reset this device's n environments, one key each; with `stagger` their step counters are random.

        Without weights, rows of the tasks are taken in order, each device beginning at its own.
        """
        num, config = keys.shape[0], self.core.config
        params = self._drawn_params(params, jnp.int32(self.first_update))
        env_keys, time_keys, row_keys = jnp.unstack(jax.vmap(lambda key: jax.random.split(key, 3))(keys), axis=1)
        first = env_index(num)  # each device starts at different rows
        episodes = first + jnp.arange(num, dtype=jnp.int32) if is_sequential(params.tasks) else None
        env = self.batch.reset(params, env_keys, None, episodes)
        if self.config.stagger:
            step = jax.vmap(lambda key: jax.random.randint(key, (), 0, config.episode_length))(time_keys)
            env = env.replace(world=env.world.replace(step=step.astype(jnp.int32)))
        rows = jax.vmap(lambda key: jax.random.split(key, self.core.num_agents))(row_keys).reshape(-1, 2)
        zero = jnp.zeros(num, jnp.float32)
        return RolloutState.build_unchecked(
            env=env.replace(info={}),
            memory=self.agent.initial_memory(len(rows)),
            is_first=jnp.ones(len(rows), bool),
            keys=rows,
            totals={"return": zero, "length": zero},
        )

    def _drawn_params(self, params: EnvParams, updates: Int[Array, ""]) -> EnvParams:
        """Return parameters with the rows of the curriculum after some updates; the same without a curriculum."""
        return scheduled_params(params, self.config.curriculum, updates - self.first_update, self.config.num_updates)

    def _update_local(self, params: EnvParams, state: TrainState) -> tuple[TrainState, dict[str, Array]]:
        """Compute one update with this device's environments; return the next state, metrics (sums in `episode/`)."""
        config, memory = self.config, state.actor.memory
        params = self._drawn_params(params, state.updates)
        policy = self.behavior_policy(state)
        actor, steps, episodes = rollout(self.batch, params, state.actor, policy, config.unroll_length)
        obs = to_rows(actor.env.obs, self.core.num_agents)
        last = self.agent.unroll_step(state.net, actor.memory, obs, actor.is_first)[2]
        advantage = compute_advantages(steps, last, config.discount, config.gae_lambda)
        batch = TrainBatch.build_unchecked(
            steps=steps, memory=memory, advantage=advantage, target=advantage + steps.outputs["value"]
        )
        key, order = jax.random.split(state.key)
        net, opt, metrics = self.optimize(self.current_loss(state), state.net, state.opt, batch, order)
        new = TrainState.build_unchecked(net=net, opt=opt, actor=actor, key=key, updates=state.updates + 1)
        metrics["dead_units"] = mean_over_devices(dead_units(actor.memory))
        return new, metrics | {f"episode/{name}": sum_over_devices(x) for name, x in episodes.items()}

    def behavior_policy(self, state: TrainState) -> Policy:
        """Return the policy that acts during training, here the network itself, which samples actions."""
        return self.policy(state.net)

    def policy(self, net: Any, greedy: bool = False) -> Policy:
        """Return the network with parameters `net` as a policy that samples actions; `greedy`: the most likely ones.

        Its other outputs are `log_prob` and `value` (R,) of each row.
        """
        choose = self.agent.distribution

        def act(memory: Array, obs: dict[str, Array], begins: Array, keys: Array) -> tuple[Array, Array, dict]:
            """Apply one step of the network; return memory, unclipped actions, and `log_prob` and `value`."""
            memory, params, value = self.agent.unroll_step(net, memory, obs, begins)
            action = choose.mode(params) if greedy else jax.vmap(choose.sample)(params, keys)
            return memory, action, {"log_prob": choose.log_prob(params, action), "value": value}

        def value(memory: Array, last: dict[str, Array], outputs: dict[str, Array]) -> Array:
            """Return values of last observations, or those of the step before."""
            if not self._evaluates_last:
                return outputs["value"]
            return self.agent.unroll_step(net, memory, last, jnp.zeros(memory.shape[0], bool))[2]

        return Policy(act, value, choose.clip, self.agent.initial_memory)

    def current_loss(self, state: TrainState) -> LossFunction:
        """Return the loss function of the update from this state; here `loss`, whatever the state."""
        return self.loss

    def loss(self, net: Any, batch: TrainBatch) -> tuple[Array, dict[str, Array]]:
        """Compute `clipped_loss` plus the auxiliary loss, and their parts by name; apply the network again."""
        params, value, further, told = self.apply_net(net, batch)
        own, parts = self.clipped_loss(params, value, batch)
        return own + further, parts | told

    def apply_net(
        self, net: Any, batch: TrainBatch
    ) -> tuple[Float[Array, "t r p"], Float[Array, "t r"], Float[Array, ""], dict[str, Array]]:
        """Apply the network to a batch from its first memory on.

        Returns:
            Distribution parameters, values, the auxiliary loss times `auxiliary_cost`, and its parts by name; 0 and
            none without an auxiliary loss.
        """
        steps = batch.steps
        if self.config.auxiliary == "none":
            _, params, value = self.agent.unroll(net, batch.memory, steps.obs, steps.is_first)
            return params, value, jnp.zeros((), jnp.float32), {}
        params, value, found = self.agent.unroll_with_predictions(net, batch.memory, steps.obs, steps.is_first)
        loss, parts = source_loss(found, steps.obs[SOURCE_TARGET])
        return params, value, self.config.auxiliary_cost * loss, {"source": loss} | parts

    def clipped_loss(self, params: Array, value: Array, batch: TrainBatch) -> tuple[Array, dict[str, Array]]:
        """Return clipped policy loss plus weighted value loss minus weighted entropy, and unweighted parts by name.

        `params` (t, r, p) and `value` (t, r) are the network's outputs for the batch. Advantages are first normalised
        to mean 0 and deviation 1 over all devices, so call it inside `EnvSharding.map` only.

        Two further parts have no effect on the loss: `kl`, from the policy that acted; and `clipped`, the fraction of
        steps whose ratio differs from 1 by more than `clip_range`.
        """
        config, steps = self.config, batch.steps
        change = self.agent.distribution.log_prob(params, steps.action) - steps.outputs["log_prob"]
        ratio, clipped = jnp.exp(change), jnp.clip(jnp.exp(change), 1 - config.clip_range, 1 + config.clip_range)
        mean = mean_over_devices(jnp.mean(batch.advantage))
        spread = jnp.sqrt(mean_over_devices(jnp.mean((batch.advantage - mean) ** 2)))
        weight = (batch.advantage - mean) / (spread + 1e-8)
        policy_loss = -jnp.mean(jnp.minimum(ratio * weight, clipped * weight))
        value_loss = 0.5 * jnp.mean((value - batch.target) ** 2)
        entropy = jnp.mean(self.agent.distribution.entropy(params))
        parts = {
            "policy": policy_loss,
            "value": value_loss,
            "entropy": entropy,
            "kl": jnp.mean(ratio - 1 - change),  # to the policy that acted; http://joschu.net/blog/kl-approx.html
            "clipped": jnp.mean((jnp.abs(ratio - 1) > config.clip_range).astype(jnp.float32)),
        }
        return policy_loss + config.value_cost * value_loss - config.entropy_cost * entropy, parts

    def optimize(
        self, loss: LossFunction, net: Any, opt: Any, batch: TrainBatch, key: Array
    ) -> tuple[Any, Any, dict[str, Array]]:
        """Take `num_epochs` passes over minibatches of whole rows, shuffled; call inside `EnvSharding.map` only.

        `num_minibatches` must divide the rows.

        Returns:
            Parameters, the optimizer's state, and means over all steps: the loss's parts as `loss/...`, and `grad_norm`
            before clipping.
        """
        num_rows = batch.memory.shape[0]

        def descend(carry: tuple[Any, Any], rows: Array) -> tuple[tuple[Any, Any], dict[str, Array]]:
            """Take one gradient step on a minibatch of rows."""
            net, opt = carry
            part = TrainBatch.build_unchecked(
                memory=batch.memory[rows],
                **{name: jax.tree.map(lambda x: x[:, rows], getattr(batch, name)) for name in TIME_MAJOR_FIELDS},
            )
            grads, parts = mean_over_devices(jax.grad(loss, has_aux=True)(net, part))
            change, opt = self.optimizer.update(grads, opt, net)
            parts = {f"loss/{name}": x for name, x in parts.items()} | {"grad_norm": optax.tree.norm(grads)}
            return (optax.apply_updates(net, change), opt), parts

        orders = jax.vmap(lambda k: jax.random.permutation(k, num_rows))(jax.random.split(key, self.config.num_epochs))
        (net, opt), parts = jax.lax.scan(
            descend, (net, opt), orders.reshape(-1, num_rows // self.config.num_minibatches)
        )
        return net, opt, jax.tree.map(jnp.mean, parts)


TIME_MAJOR_FIELDS = ("steps", "advantage", "target")  # fields of `TrainBatch` with a leading axis of time


def make_agent(core: HouseholdEnv, config: PPOConfig) -> RecurrentAgent:
    """Build the network for observations and actions of one agent of an environment; all agents share it."""
    specs = {name: spec.for_one_agent(core.num_agents) for name, spec in core.observation_spec.items()}
    num = NUM_PREDICTIONS[config.auxiliary]
    return RecurrentAgent.from_specs(specs, core.action_spec.for_one_agent(core.num_agents), config.network, num)


def make_optimizer(config: PPOConfig) -> optax.GradientTransformation:
    """Build "adam" or "lamb" with a linear learning rate over all gradient steps, after clipping the global norm.

    The rate goes from `learning_rate` to `final_rate` times that, and stays there.
    """
    num = config.num_updates * config.num_epochs * config.num_minibatches
    rate = optax.linear_schedule(config.learning_rate, config.learning_rate * config.final_rate, num)
    kind = {"adam": lambda: optax.adamw(rate, eps=1e-5, weight_decay=config.weight_decay),
            "lamb": lambda: optax.lamb(rate, weight_decay=config.weight_decay)}  # fmt: skip
    return optax.chain(optax.clip_by_global_norm(config.max_grad_norm), kind[config.optimizer]())
