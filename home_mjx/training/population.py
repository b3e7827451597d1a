"""Several seeds of a training in one program: one batch of environments, and networks with an axis of seeds."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array

from home_mjx.core.checks import check_number
from home_mjx.sharding import BY_ENV, REPLICATED, sum_over_devices
from home_mjx.tasks.base.state import EnvParams, to_raw_key
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.training.config import PPOConfig
from home_mjx.training.ppo import PPO, TrainBatch, TrainState
from home_mjx.training.rollout import Policy, Transitions, compute_advantages, rollout, to_rows


class Population:
    """PPO of several seeds at once; no seed depends on another.

    All environments are one batch, so that resets and rays cost as much as for one seed of as many environments. The
    network and its gradients are mapped over the seeds (`jax.vmap`).

    Args:
        core: The environment's functions.
        config: Options of each seed.
        num_seeds: Number of seeds.
        devices: Devices to train on; all of JAX's by default.
        learner: `PPO`, or a subclass such as `AdvisedPPO`.

    Attributes:
        member: The learner of a single seed: `member.policy(population.net_of(state, i))` is that of seed i.
        update: Compiled function from `(params, state)` to the next state and metrics, each with an axis of seeds.

    Raises:
        ConfigError: As in `PPO`.

    Example:
        >>> population = Population(env.core, PPOConfig(num_envs=512), num_seeds=4)  # doctest: +SKIP
        >>> state = population.init(env.params, jax.random.key(0))  # doctest: +SKIP
        >>> state, metrics = population.update(env.params, state)  # doctest: +SKIP
        >>> metrics["episode/success"] / metrics["episode/episodes"]  # of each seed  # doctest: +SKIP
    """

    def __init__(
        self,
        core: HouseholdEnv,
        config: PPOConfig,
        num_seeds: int,
        devices: Sequence[Any] | None = None,
        learner: type[PPO] = PPO,
    ) -> None:
        check_number("num_seeds", num_seeds, 1, integer=True)
        self.num_seeds, self.member = num_seeds, learner(core, config, devices)
        steps = config.num_timesteps * num_seeds
        self._whole = learner(core, replace(config, num_envs=config.num_envs * num_seeds, num_timesteps=steps), devices)
        self.sharding = self._whole.sharding
        specs = TrainState.build_unchecked(
            net=REPLICATED, opt=REPLICATED, actor=BY_ENV, key=REPLICATED, updates=REPLICATED
        )
        self.update = self.sharding.map(self._update_local, (self.sharding.params, specs), (specs, REPLICATED))

    def init(self, params: EnvParams, key: Array) -> TrainState:
        """Return a state with fresh parameters and an optimizer for each seed, and reset environments."""
        state = self._whole.init(params, key)
        own = jax.random.fold_in(jax.random.wrap_key_data(to_raw_key(key)), 1)  # `init` of the whole splits the key
        keys = jax.random.key_data(jax.random.split(own, 2 * self.num_seeds))
        net = jax.vmap(self.member.agent.init_net)(keys[: self.num_seeds])
        opt = jax.vmap(self.member.optimizer.init)(net)
        return self._whole.to_devices(state.replace(net=net, opt=opt, key=keys[self.num_seeds :]))

    def net_of(self, state: TrainState, seed: int) -> Any:
        """Return the parameters of a seed, from 0."""
        return jax.tree.map(lambda x: x[seed], state.net)

    def _split(self, rows: Any, axis: int = 0) -> Any:
        """Split an axis of rows, by seed, into a leading axis of seeds and the rows of each."""
        return jax.tree.map(
            lambda x: jnp.moveaxis(
                x.reshape(*x.shape[:axis], self.num_seeds, -1, *x.shape[axis + 1 :]), axis, 0
            ),
            rows,
        )  # fmt: skip

    def _policy(self, state: TrainState) -> Policy:
        """Return the policy that acts during training: each seed's own in its rows."""

        def own(net: Any) -> Policy:
            return self.member.behavior_policy(state.replace(net=net))

        def merge(tree: Any) -> Any:
            return jax.tree.map(lambda x: x.reshape(-1, *x.shape[2:]), tree)

        def act(*given: Any) -> Any:
            """Act with the network of each seed."""
            return merge(jax.vmap(lambda net, *parts: own(net).act(*parts))(state.net, *map(self._split, given)))

        def value(*given: Any) -> Array:
            """Return values by the network of each seed."""

            def one(net: Any, *parts: Any) -> Array:
                estimate = own(net).value
                assert estimate is not None
                return estimate(*parts)

            return merge(jax.vmap(one)(state.net, *map(self._split, given)))

        return self.member.policy(None)._replace(act=act, value=value)

    def _update_local(self, params: EnvParams, state: TrainState) -> tuple[TrainState, dict[str, Array]]:
        """Compute one update of all seeds with this device's environments, as `PPO` does for one."""
        member, config = self.member, self.member.config
        params = member._drawn_params(params, state.updates)
        memory = state.actor.memory
        actor, steps, episodes = rollout(
            self._whole.batch, params, state.actor, self._policy(state), config.unroll_length, self.num_seeds
        )
        obs = to_rows(actor.env.obs, member.core.num_agents)
        values = jax.vmap(lambda *given: member.agent.unroll_step(*given)[2])
        last = values(state.net, *map(self._split, (actor.memory, obs, actor.is_first))).reshape(-1)
        batch = self._batch(steps, memory, compute_advantages(steps, last, config.discount, config.gae_lambda))
        keys = jax.vmap(jax.random.split)(state.key)

        def learn(net: Any, opt: Any, batch: TrainBatch, key: Array) -> tuple[Any, Any, dict[str, Array]]:
            return member.optimize(member.current_loss(state), net, opt, batch, key)

        net, opt, metrics = jax.vmap(learn)(state.net, state.opt, batch, keys[:, 1])
        new = state.replace(net=net, opt=opt, actor=actor, key=keys[:, 0], updates=state.updates + 1)
        return new, metrics | {f"episode/{name}": sum_over_devices(x) for name, x in episodes.items()}

    def _batch(self, steps: Transitions, memory: Array, advantage: Array) -> TrainBatch:
        """Return the training data of each seed."""
        by_time = lambda tree: self._split(tree, 1)  # noqa: E731
        return TrainBatch.build_unchecked(
            steps=by_time(steps),
            memory=self._split(memory),
            advantage=by_time(advantage),
            target=by_time(advantage + steps.outputs["value"]),
        )
