"""Auto-reset of a batch of environments."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from home_mjx.bank.bank import HouseBank
from home_mjx.tasks.base.keys import RENEW, fold
from home_mjx.tasks.base.state import State
from home_mjx.tasks.environment.household import HouseholdEnv


class AutoReset:
    """A batch of environments that begin anew, in a new house and pose, when they are done.

    The state that comes back from a final step is the first of the next episode; its `done` and `reward` are still
    those of the final step, and `info["final_obs"]` holds the final observation (the current one where nothing ended).

    Args:
        env: The environment.

    Example:
        >>> batch = AutoReset(env)  # doctest: +SKIP
        >>> states = batch.reset(jax.random.split(jax.random.key(0), 64))  # doctest: +SKIP
        >>> states = jax.jit(batch.step)(states, actions)  # doctest: +SKIP
    """

    def __init__(self, env: HouseholdEnv) -> None:
        self.env = env

    def reset(self, keys: Array) -> State:
        """A new episode per key."""
        return self.reset_in(self.env.bank, keys)

    def step(self, state: State, action: Float[Array, "n ..."]) -> State:
        """One step of all environments."""
        return self.step_in(self.env.bank, state, action)

    def reset_in(self, bank: HouseBank, keys: Array) -> State:
        """`reset` with an explicit bank."""
        state = jax.vmap(lambda key: self.env.reset_in(bank, key))(keys)
        return state.replace(info=dict(state.info, final_obs=state.obs))

    def step_in(self, bank: HouseBank, state: State, action: Float[Array, "n ..."]) -> State:
        """`step` with an explicit bank."""
        inner = state.replace(info={k: v for k, v in state.info.items() if k != "final_obs"})
        stepped = jax.vmap(lambda s, a: self.env.step_in(bank, s, a))(inner, action)
        # A branch on the whole batch: nothing is reset, and nothing rendered twice, on steps in which nobody is done.
        fresh = jax.lax.cond(jnp.any(stepped.done > 0), lambda s: self._renew(bank, s), lambda s: s, stepped)
        info = dict(fresh.info, final_obs=stepped.obs, truncation=stepped.info["truncation"])
        info["agent_done"] = stepped.info["agent_done"]
        return fresh.replace(info=info, reward=stepped.reward, done=stepped.done, metrics=stepped.metrics)

    def _renew(self, bank: HouseBank, state: State) -> State:
        def one(state: State) -> State:
            key = fold(state.info["world"].key, RENEW)
            new = self.env.reset_in(bank, key)
            info = dict(state.info, **new.info)
            new = new.replace(metrics=dict(state.metrics, **new.metrics), info=info)
            return jax.tree.map(lambda a, b: jnp.where(state.done > 0, a, b), new, state)

        return jax.vmap(one)(state)
