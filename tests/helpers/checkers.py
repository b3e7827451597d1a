"""Each ecosystem's own checkers, wrappers and loops, for any id: slow tests and `make checkers` run them.

A check raises what went wrong; `ConfigError` where the adapter refuses the id.
"""

import importlib.util
from collections.abc import Callable
from typing import Any

import gymnasium
import jax
import jax.numpy as jnp
import numpy as np
from adapted import CHEAP, assert_equal, cheap
from gymnasium.utils.env_checker import check_env

import home_mjx
import home_mjx.tasks.suite
from home_mjx.registry import find_spec

NUM_ENVS, NUM_STEPS = 3, 7


def options_of(env_id: str, **more: Any) -> dict[str, Any]:
    """Options with which an id compiles fast: few rows, kinematic physics, no images and no sound, five steps."""
    task = getattr(home_mjx.tasks.suite, find_spec(env_id).entry_point.partition(":")[2])
    few = {"num_tasks": 4, "follow_steps": 3}
    rows = {name: value for name, value in few.items() if hasattr(task, name)}
    senses = (*CHEAP["sensors"], *task().observation_spec)
    return {**CHEAP, "sensors": senses, "impl": "kinematic", **rows, **more}


def numbers_for(env_id: str) -> dict[str, Any]:
    """The same, driven by numbers: nobody has to say `stopped` then."""
    return options_of(env_id, actions="continuous", **({"stop": False} if "stop" in find_spec(env_id).options else {}))


def team_of(env_id: str) -> int:
    """Agents of an id, at least two."""
    return max(2, find_spec(env_id).options.get("num_agents", 1))


def check_gymnasium(env_id: str, bank: Any) -> None:
    """Gymnasium's `check_env`; pictures are checked with PointNav alone."""
    env = gymnasium.make(f"home_mjx/{env_id}", houses=bank, **options_of(env_id))
    check_env(env.unwrapped, skip_render_check=True)


def check_vector_env(env_id: str, bank: Any) -> None:
    """`make_vec`, Gymnasium's own wrapper that counts episodes, and batched spaces."""
    env = gymnasium.make_vec(f"home_mjx/{env_id}", num_envs=NUM_ENVS, houses=bank, **options_of(env_id))
    assert env.metadata["autoreset_mode"] == gymnasium.vector.AutoresetMode.SAME_STEP
    env = gymnasium.wrappers.vector.RecordEpisodeStatistics(env)
    first, _ = env.reset(seed=0)
    again, _ = env.reset(seed=0)
    assert_equal(first, again)
    assert env.observation_space.contains(first)
    env.action_space.seed(0)
    for _ in range(2 * CHEAP["episode_length"]):
        obs, reward, terminated, truncated, info = env.step(env.action_space.sample())
        assert env.observation_space.contains(obs)
        assert reward.shape == terminated.shape == truncated.shape == (NUM_ENVS,)
        over = terminated | truncated
        if over.any():
            assert set(info["episode"]["l"][over]) <= set(range(1, CHEAP["episode_length"] + 1))
    assert env.episode_count >= 2 * NUM_ENVS


def check_brax(env_id: str, bank: Any) -> None:
    """Brax's `Evaluator`, on the wrapper that its trainers take."""
    from brax.training.acting import Evaluator

    from home_mjx.adapters.brax import BraxEnv, wrap_for_training

    env = BraxEnv(home_mjx.make(env_id, bank, **numbers_for(env_id)))
    evaluator = Evaluator(
        wrap_for_training(env, episode_length=5),
        lambda params: lambda obs, key: (jax.random.uniform(key, (NUM_ENVS, env.action_size), minval=-1), {}),
        num_eval_envs=NUM_ENVS,
        episode_length=5,
        action_repeat=1,
        key=jax.random.PRNGKey(0),
    )
    metrics = evaluator.run_evaluation(None, {})
    assert 1 <= metrics["eval/avg_episode_length"] <= 5
    assert np.isfinite([value for name, value in metrics.items() if "reward" in name]).all()


def check_playground(env_id: str, bank: Any) -> None:
    """Playground's registry and its wrapper, which begins with the first state again."""
    from mujoco_playground import MjxEnv, registry, wrapper

    from home_mjx.adapters import playground

    playground.register()
    env = registry.load(env_id, config_overrides={**numbers_for(env_id), "houses": bank})
    assert isinstance(env, MjxEnv)
    wrapped = wrapper.wrap_for_brax_training(env, episode_length=2)
    state = jax.jit(wrapped.reset)(jax.random.split(jax.random.PRNGKey(0), NUM_ENVS))
    first, step = state.obs, jax.jit(wrapped.step)
    assert {name: x.shape[1:] for name, x in first.items()} == env.observation_size
    for number in (1, 2):
        tree = jax.tree.structure(state)
        state = step(state, jnp.ones((NUM_ENVS, env.action_size)))
        assert jax.tree.structure(state) == tree
        np.testing.assert_array_equal(state.done, float(number == 2))
    np.testing.assert_array_equal(state.info["truncation"], 1.0)
    assert_equal(state.obs, first)


def check_pettingzoo(env_id: str, bank: Any, **more: Any) -> None:
    """PettingZoo's `parallel_api_test` and `parallel_seed_test`."""
    from pettingzoo.test import parallel_api_test, parallel_seed_test

    from home_mjx.adapters.pettingzoo import PettingZooEnv

    options = options_of(env_id, **{"num_agents": team_of(env_id), **more})

    def make() -> PettingZooEnv:
        return PettingZooEnv(env_id, houses=bank, **options)

    parallel_api_test(make(), num_cycles=20)
    parallel_seed_test(make, num_cycles=20)


def marl_rollout(env: Any) -> Callable[[Any], Any]:
    """As JaxMARL's trainers collect experience, with the states."""

    @jax.jit
    def run(key):
        obs, state = jax.vmap(env.reset)(jax.random.split(key, NUM_ENVS))

        def step(carry, key):
            obs, state = carry
            act, move = jax.random.split(key)
            keys = jax.random.split(act, (len(env.agents), NUM_ENVS))
            actions = {a: jax.vmap(env.action_space(a).sample)(keys[i]) for i, a in enumerate(env.agents)}
            new_obs, new, *rest = jax.vmap(env.step)(jax.random.split(move, NUM_ENVS), state, actions)
            return (new_obs, new), (obs, state, actions, new_obs, new, *rest)

        return jax.lax.scan(step, (obs, state), jax.random.split(key, NUM_STEPS))[1]

    return run


def check_jaxmarl(env_id: str, bank: Any, **more: Any) -> None:
    """A loop like those of JaxMARL's trainers: every transition is that of the core, which resets nothing."""
    from jaxmarl.environments.multi_agent_env import MultiAgentEnv

    from home_mjx.adapters.jaxmarl import JaxMarlEnv

    env = JaxMarlEnv(
        home_mjx.make(env_id, bank, **options_of(env_id, **{"num_agents": team_of(env_id), **more})), vector=False
    )
    assert isinstance(env, MultiAgentEnv)
    assert env.agents == [f"agent_{i}" for i in range(env.num_agents)]
    assert env.name == env_id
    obs, state, taken, new_obs, new, rewards, dones, infos = marl_rollout(env)(jax.random.key(0))

    alone = env.num_agents == 1
    action = jnp.stack([taken[agent] for agent in env.agents], axis=2)
    action = action[:, :, 0] if alone else action
    core = jax.jit(jax.vmap(jax.vmap(env.env.core.step, (None, 0, 0)), (None, 0, 0)))(env.env.params, state, action)
    done = np.asarray(core.done)
    assert set(dones) == {*env.agents, "__all__"}
    assert set(rewards) == set(obs) == set(env.agents)
    for i, agent in enumerate(env.agents):
        assert jax.vmap(jax.vmap(env.observation_space(agent).contains))(obs[agent]).all()
        assert jax.vmap(jax.vmap(env.action_space(agent).contains))(taken[agent]).all()
        own, seen = (x if alone else x[:, :, i] for x in (core.reward, core.obs["state"]))
        np.testing.assert_allclose(rewards[agent], own, atol=1e-6)
        np.testing.assert_allclose(new_obs[agent]["state"][~done], seen[~done], atol=1e-5)
    assert all((np.asarray(x) == done).all() for x in dones.values())
    assert done.any(axis=0).all()
    np.testing.assert_array_equal(new.world.step, np.where(done, 0, np.asarray(state.world.step) + 1))
    assert {np.shape(x) for x in infos.values()} == {(NUM_STEPS, NUM_ENVS, env.num_agents)}
    np.testing.assert_array_equal(
        infos["terminated"] | infos["truncated"], np.repeat(done[..., None], env.num_agents, -1)
    )


def gymnax_rollout(env: Any) -> Callable[[Any, Any], Any]:
    """As purejaxrl collects experience, with the states."""
    space = env.action_space(env.default_params)

    @jax.jit
    def run(params, key):
        obs, state = jax.vmap(env.reset, in_axes=(0, None))(jax.random.split(key, NUM_ENVS), params)

        def step(carry, key):
            obs, state = carry
            act, move = jax.random.split(key)
            action = jax.vmap(space.sample)(jax.random.split(act, NUM_ENVS))
            keys = jax.random.split(move, NUM_ENVS)
            new_obs, new, reward, terminated, truncated, info = jax.vmap(env.step, in_axes=(0, 0, 0, None))(
                keys, state, action, params
            )
            return (new_obs, new), (obs, state, action, new_obs, new, reward, terminated, truncated, info)

        return jax.lax.scan(step, (obs, state), jax.random.split(key, NUM_STEPS))[1]

    return run


def check_gymnax(env_id: str, bank: Any, **more: Any) -> None:
    """The loop of purejaxrl: every transition is that of the core, which resets nothing."""
    from home_mjx.adapters.gymnax import GymnaxEnv

    env = GymnaxEnv(home_mjx.make(env_id, bank, **options_of(env_id, **more)))
    params = env.default_params
    obs, state, action, new_obs, new, reward, terminated, truncated, info = gymnax_rollout(env)(
        params, jax.random.key(0)
    )
    contains = jax.vmap(jax.vmap(env.observation_space(params).contains))
    assert contains(obs).all()
    assert contains(info["final_observation"]).all()
    assert jax.vmap(jax.vmap(env.action_space(params).contains))(action).all()

    core = jax.jit(jax.vmap(jax.vmap(env.env.core.step, (None, 0, 0)), (None, 0, 0)))(params, state, action)
    assert_equal(core.terminated, terminated)
    assert_equal(core.truncated, truncated)
    assert_equal((info["terminated"], info["truncated"]), (terminated, truncated))
    np.testing.assert_allclose(core.reward, reward, atol=1e-6)
    jax.tree.map(lambda a, b: np.testing.assert_allclose(a, b, atol=1e-5), core.obs, info["final_observation"])

    done = np.asarray(terminated | truncated)
    assert done.any(axis=0).all()
    assert_equal(np.asarray(truncated & (state.world.step != 4)), np.zeros_like(done))
    np.testing.assert_array_equal(new.world.step, np.where(done, 0, np.asarray(state.world.step) + 1))
    changed = (np.asarray(new_obs["state"]) != np.asarray(info["final_observation"]["state"])).any(axis=-1)
    np.testing.assert_array_equal(changed, done)


def check_pytorch(env_id: str, bank: Any) -> None:
    """A step of a batch with PyTorch's tensors: they lie where JAX's arrays do, and do the same."""
    import torch

    from home_mjx.adapters.pytorch import to_jax, to_torch

    single = cheap(env_id, bank, **options_of(env_id))
    batch = home_mjx.AutoReset(single.core).bind(single.params)
    states, step = jax.jit(batch.reset)(jax.random.split(jax.random.key(0), NUM_ENVS)), jax.jit(batch.step)
    shape = (NUM_ENVS, *single.action_spec.shape)
    actions = torch.ones(shape, dtype=getattr(torch, str(single.action_spec.dtype)))
    stepped = step(states, to_jax(actions))
    assert to_jax(actions).unsafe_buffer_pointer() == actions.data_ptr()
    tensors = to_torch(stepped.obs)
    for name, array in stepped.obs.items():
        assert tensors[name].data_ptr() == array.unsafe_buffer_pointer()
    assert_equal(step(states, jnp.asarray(actions.numpy())).obs, stepped.obs)


CHECKERS: dict[str, Callable[[str, Any], None]] = {
    "Gymnasium `Env`": check_gymnasium,
    "Gymnasium `VectorEnv`": check_vector_env,
    "Brax": check_brax,
    "Playground": check_playground,
    "PettingZoo": check_pettingzoo,
    "JaxMARL": check_jaxmarl,
    "gymnax": check_gymnax,
    "PyTorch": check_pytorch,
}

NEEDS = {
    "Brax": "brax", "Playground": "mujoco_playground", "PettingZoo": "pettingzoo", "JaxMARL": "jaxmarl",
    "PyTorch": "torch",
}  # fmt: skip


def is_installed(adapter: str) -> bool:
    """Whether the package is there that an adapter needs."""
    return adapter not in NEEDS or importlib.util.find_spec(NEEDS[adapter]) is not None
