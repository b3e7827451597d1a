"""Every row of an environment's task bank, played to its end."""

import jax
import jax.numpy as jnp


def begun(env):
    """States at the start of every row, one after the other."""
    rows = len(env.params.tasks)
    keys, index = jax.random.split(jax.random.key(0), rows), jnp.arange(rows)
    return jax.jit(jax.vmap(env.core.reset, (None, 0, None, 0)))(env.params, keys, None, index)


def played(env, states, act, most_steps):
    """The states when all have ended, or after so many steps; `act(state, key)` chooses each action."""

    def step(state, key):
        after = env.core.step(env.params, state, act(state, key))
        return jax.tree.map(lambda old, new: jnp.where(state.done, old, new), state, after)

    def body(carry):
        number, states = carry
        keys = jax.random.split(jax.random.fold_in(jax.random.key(1), number), states.done.shape[0])
        return number + 1, jax.vmap(step)(states, keys)

    go = lambda carry: (carry[0] < most_steps) & ~jnp.all(carry[1].done)  # noqa: E731
    return jax.jit(lambda s: jax.lax.while_loop(go, body, (0, s))[1])(states)
