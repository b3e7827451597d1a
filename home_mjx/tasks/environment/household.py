"""The environment: houses, physics, sensors and a task in one jitted step."""

import functools
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx import physics
from home_mjx.bank.bank import HouseBank
from home_mjx.bank.records import BankSpec
from home_mjx.core.transforms import body_quat
from home_mjx.errors import ConfigError
from home_mjx.navigation.grid import geodesic_distance
from home_mjx.navigation.spawn import random_source, spread_starts
from home_mjx.raycast_render.scene.scene import make_scene
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.tasks.base.config import EnvConfig
from home_mjx.tasks.base.keys import split, to_raw
from home_mjx.tasks.base.pose import AgentPose
from home_mjx.tasks.base.state import State, World
from home_mjx.tasks.environment.episodes import Episodes
from home_mjx.tasks.sensors import observe as sensors
from home_mjx.tasks.suite.point_nav import PointNav


class HouseholdEnv:
    """Agents in houses. Every method is for one environment: use `jax.vmap` for many.

    The core takes the bank as an argument: `reset_in(bank, key)`, `step_in(bank, state, action)`,
    `observe_in(bank, state)`. `reset(key)` and `step(state, action)` bind `env.bank`, which a jitted caller then
    bakes in as a constant: right for short scripts, Brax and Playground, wasteful above about 1 GB.

    Args:
        bank: The houses.
        config: Options, see `EnvConfig`.
        task: Goal and reward.

    Example:
        >>> env = home_mjx.make("PointNav-v0")  # doctest: +SKIP
        >>> states = jax.vmap(env.reset)(jax.random.split(jax.random.key(0), 64))  # doctest: +SKIP
        >>> states = jax.jit(jax.vmap(env.step))(states, jnp.zeros((64, env.action_size)))  # doctest: +SKIP
    """

    def __init__(self, bank: HouseBank, config: EnvConfig | None = None, task: PointNav | None = None) -> None:
        self.bank = bank
        self.config = config or EnvConfig()
        self.task = task or PointNav()
        # Now, not in the first trace: arrays made inside `pmap` or `shard_map` belong to that mesh for ever.
        self._template(bank)

    @property
    def num_agents(self) -> int:
        """Agents per environment."""
        return self.config.physics.num_agents

    @property
    def action_size(self) -> int:
        """Numbers per agent: forward, left, turn left, look up, each in [-1, 1] of its fastest rate."""
        return 4

    @property
    def dt(self) -> float:
        """Seconds per step."""
        return self.config.physics.ctrl_dt

    @functools.cached_property
    def observation_shapes(self) -> dict[str, jax.ShapeDtypeStruct]:
        """Shape and dtype of every observation."""
        return jax.eval_shape(self.reset, jax.ShapeDtypeStruct((2,), jnp.uint32)).obs

    def reset(self, key: Array, episode: Episodes | None = None) -> State:
        """`reset_in` with the environment's own bank."""
        return self.reset_in(self.bank, key, episode=episode)

    def step(self, state: State, action: Float[Array, "..."]) -> State:
        """`step_in` with the environment's own bank."""
        return self.step_in(self.bank, state, action)

    def reset_in(
        self, bank: HouseBank, key: Array, house: Int[Array, ""] | None = None, episode: Episodes | None = None
    ) -> State:
        """A new episode.

        Args:
            bank: The houses.
            key: Typed or raw uint32 key.
            house: Index of the house, the nearest one that there is if out of range; None draws one.
            episode: One row of an `Episodes`: house, start and goal of the first agent; the key draws the rest.

        Returns:
            A state with its first observation, zero reward and done 0.
        """
        return self.observe_in(bank, self.begin(bank, key, house, episode))

    def begin(
        self, bank: HouseBank, key: Array, house: Int[Array, ""] | None = None, episode: Episodes | None = None
    ) -> State:
        """A new episode without observation: `obs` is empty until `observe_in`."""
        keep, draw, start_key, yaw_key, goal_key, source_key = split(to_raw(key), 6)
        if episode is not None:
            house = episode.house
        elif house is None:
            house = bank.draw[jax.random.randint(draw, (), 0, bank.num_houses)]
        house = bank.known_house(house)
        agents = self.num_agents
        start, pos = spread_starts(bank, house, agents, 4 * self.config.physics.agent_radius, start_key)
        yaw = jax.random.uniform(yaw_key, (agents,), jnp.float32, -jnp.pi, jnp.pi)
        goal = self.task.choose_goal(bank, house, start[0], goal_key)
        if episode is not None:
            pos, yaw, goal = pos.at[0].set(episode.start), yaw.at[0].set(episode.yaw), episode.goal
        world = World(
            key=to_raw(keep),
            house=house,
            pitch=jnp.zeros(agents, jnp.float32),
            goal=goal,
            distance=self._distance(bank, house, goal, pos),
            source=random_source(bank, house, self.config.source_height, source_key),
            phase=jnp.zeros((), jnp.int32),
            response=jnp.zeros((agents, 2, self._response_length), jnp.float32),
            step=jnp.zeros((), jnp.int32),
        )
        data = physics.reset(self._template(bank), bank, house, pos, yaw)
        zero = jnp.zeros(agents, jnp.float32)
        _, _, metrics = self.task.score(world.distance, world.distance, zero > 0)
        metrics = jax.tree.map(jnp.zeros_like, metrics)
        info = {"world": world, "truncation": jnp.zeros((), jnp.float32), "agent_done": zero}
        return self._squeeze(State(data, {}, zero, jnp.zeros((), jnp.float32), metrics, info))

    def step_in(self, bank: HouseBank, state: State, action: Float[Array, "..."]) -> State:
        """One control step of `dt` seconds, then reward and observation.

        Args:
            bank: The houses; may differ from the last call's as long as its spec is the same.
            state: The state before.
            action: (4,), or (A, 4) for several agents: forward, left, turn left, look up in [-1, 1]; clipped.
                NaN counts as 0, lest one bad number of a policy spoils an environment for good.

        Returns:
            The state after. An episode that is over is not reset: see `AutoReset`.
        """
        return self.observe_in(bank, self.advance(bank, state, action), fade=True)

    def advance(self, bank: HouseBank, state: State, action: Float[Array, "..."]) -> State:
        """Physics, reward and done of one step, without observation."""
        world: World = state.info["world"]
        action = self._usable(action)
        template = self._template(bank)
        data = physics.step(template, bank, world.house, state.data, action[:, :3])
        look = action[:, 3] * jnp.float32(self.config.look_rate * self.dt)
        limit = self.config.pitch_max
        pos, _ = physics.agent_pose(template, data)
        distance = self._distance(bank, world.house, world.goal, pos)
        distance = jnp.where(jnp.isfinite(distance), distance, world.distance)
        world_new = world.replace(
            pitch=jnp.clip(world.pitch + look, -limit, limit),
            distance=distance,
            phase=sensors.next_phase(self.config, world.phase),
            step=world.step + 1,
        )
        contact = physics.agent_contact(template, data)
        reward, success, metrics = self.task.score(world.distance, distance, contact)
        over = world_new.step >= self.config.episode_length
        done = jnp.all(success)
        info = dict(
            state.info,
            world=world_new,
            truncation=(over & ~done).astype(jnp.float32),
            agent_done=success.astype(jnp.float32),
        )
        metrics = dict(state.metrics, **metrics)  # keep what wrappers added
        return self._squeeze(State(data, {}, reward, (done | over).astype(jnp.float32), metrics, info))

    def observe_in(self, bank: HouseBank, state: State, fade: bool = False) -> State:
        """The state with its observations.

        Args:
            bank: The houses.
            state: A state, of which only bodies and world count.
            fade: Fade the sound from the response of the last frame to the present one.
        """
        world: World = state.info["world"]
        config, template = self.config, self._template(bank)
        pose = self.pose(bank, state)
        obs: dict[str, Array] = {}
        scene = self.scene(bank, state)
        obs.update(sensors.observe_images(config, bank, scene, pose))
        if "audio" in config.sensors:
            response = sensors.hear(config, bank, scene, pose, world)
            obs["audio"] = sensors.observe_sound(config, world, world.response if fade else response, response)
            world = world.replace(response=response)
        if "state" in config.sensors:
            velocity = physics.agent_velocity(template, state.data)
            obs["state"] = sensors.observe_state(pose, velocity, physics.agent_contact(template, state.data))
        if "goal" in config.sensors:
            obs["goal"] = self.task.goal_observation(bank.navigation.goal[world.house, world.goal], pose)
        if self.num_agents == 1:
            obs = {name: value[0] for name, value in obs.items()}
        return state.replace(obs=obs, info=dict(state.info, world=world))

    def pose(self, bank: HouseBank, state: State) -> AgentPose:
        """Where every agent is and looks."""
        pos, yaw = physics.agent_pose(self._template(bank), state.data)
        return AgentPose(pos=pos, yaw=yaw, pitch=state.info["world"].pitch)

    def scene(self, bank: HouseBank, state: State) -> Scene:
        """The environment as rays see it."""
        pose = self.pose(bank, state)
        body_pos, body_quats = physics.body_pose(self._template(bank), state.data)
        house = state.info["world"].house
        quat = jax.vmap(body_quat)(pose.yaw)
        return make_scene(bank, house, body_pos, body_quats, pose.pos, quat, executor=self.config.executor)

    def _usable(self, action: Float[Array, "..."]) -> Float[Array, "a 4"]:
        shape = self.num_agents, self.action_size
        if action.shape != shape and action.shape != shape[1:] * (shape[0] == 1):
            raise ConfigError(f"expected an action of shape {shape if shape[0] > 1 else shape[1:]}, got {action.shape}")
        action = action.astype(jnp.float32).reshape(shape)
        return jnp.clip(jnp.where(jnp.isnan(action), 0.0, action), -1.0, 1.0)

    @property
    def _response_length(self) -> int:
        return self.config.audio.response_length if "audio" in self.config.sensors else 0

    def _template(self, bank: HouseBank) -> Any:
        return _template(self.config.physics, bank.spec)

    def _distance(self, bank: HouseBank, house: Array, goal: Array, pos: Float[Array, "a 3"]) -> Float[Array, " a"]:
        return jax.vmap(lambda p: geodesic_distance(bank, house, goal, p))(pos)

    def _squeeze(self, state: State) -> State:
        return state.replace(reward=state.reward[0]) if self.num_agents == 1 else state


@functools.lru_cache(maxsize=32)
def _template(config: physics.PhysicsConfig, spec: BankSpec) -> Any:
    # Built once per capacity; inside a trace it must hold no tracers.
    with jax.ensure_compile_time_eval():
        return physics.Template(config, spec)
