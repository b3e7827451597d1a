"""The environment: houses, physics, sensors and a task in one jitted step."""

from typing import Any

import jax
import jax.numpy as jnp
from jax.typing import ArrayLike
from jaxtyping import Array, Int

from home_mjx import physics
from home_mjx.bank.bank import HouseBank
from home_mjx.errors import ConfigError
from home_mjx.houses.bakes import Bake
from home_mjx.physics import PhysicsState
from home_mjx.physics.hands import obey, settle
from home_mjx.tasks.base.config import EnvConfig
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.base.specs import Specs
from home_mjx.tasks.base.state import EnvParams, State, World
from home_mjx.tasks.base.status import flags
from home_mjx.tasks.base.task import Task
from home_mjx.tasks.contact_sounds.happen import after_step
from home_mjx.tasks.env.begin import first_instant, lost_weights, snapshot_of, template_of
from home_mjx.tasks.env.bound import BoundEnv
from home_mjx.tasks.env.handling import hand_commands
from home_mjx.tasks.env.moves import (
    Moves,
    action_names,
    action_spec,
    moves_of,
    spoken_tokens,
    tilted,
    with_led,
    with_noise,
)
from home_mjx.tasks.env.usable import check_fit, check_observations, check_task, checked_metrics
from home_mjx.tasks.sensors.choose import choose_sensors, keepers, sensor_names
from home_mjx.tasks.suite.point_nav import PointNav


class HouseholdEnv:
    """Agents in houses: the core, whose functions take `EnvParams` first. Each is for one environment: use `jax.vmap`.

    `reset(params, key)`, `step(params, state, action)` and `observe(params, state)` return the same tree. Nothing of a
    bank is baked into the compiled program. `bind(bank)` gives a `BoundEnv`: `reset(key)` and `step(state, action)`.

    Args:
        config: Options, see `EnvConfig`.
        task: What agents are to do.

    Attributes:
        config: The options, sensors named.
        task: The task.
        own_config: The options of the agents that act alone, as sensors get them.
        sensors: The sensors, those of the task apart.
        action_spec: Forward, left, turn left, look up: each in [-1, 1] of its fastest rate. Discrete: the number of one
            of `action_names`.
        observation_spec: What `State.obs` holds, by name; with a leading agent axis for several agents that act.

    Raises:
        ConfigError: A sensor or a word is unknown, two observations have the same name, or the task cannot be done with
            these actions or so many agents.

    Example:
        >>> core, params = HouseholdEnv(), EnvParams(bank)  # doctest: +SKIP
        >>> reset = jax.jit(jax.vmap(core.reset, in_axes=(None, 0)))  # doctest: +SKIP
        >>> states = reset(params, jax.random.split(jax.random.key(0), 64))  # doctest: +SKIP
    """

    def __init__(self, config: EnvConfig | None = None, task: Task | None = None) -> None:
        if isinstance(config, HouseBank):
            raise ConfigError("HouseholdEnv takes options, not a bank", hint="Write HouseholdEnv(config).bind(bank).")
        self.task = task or PointNav()
        config = config or EnvConfig()
        check_fit(config, self.task)
        self.config = config.replace(
            sensors=sensor_names(config, self.task),
            num_sources=max(config.num_sources, self.task.num_sources),
            clips=tuple(dict.fromkeys((*config.clips, *self.task.clips))),
            speech=tuple(dict.fromkeys((*config.speech, *self.task.speech))),
        )
        self.own_config = self.config.of_first(self.num_agents)
        self.sensors = choose_sensors(self.own_config, self.task)
        spoken_tokens(self.config)  # refuses what cannot be said
        self.action_spec = action_spec(self.own_config)
        self.observation_spec = self._observation_spec()

    @property
    def num_agents(self) -> int:
        """Agents per environment that act: of whom there are actions, observations and rewards.

        All but those that the task keeps for itself, see `Task.num_acting`; `config.num_agents` counts these as well.
        """
        return self.task.num_acting or self.config.num_agents

    @property
    def dt(self) -> float:
        """Seconds per step."""
        return self.config.timing.ctrl_dt

    @property
    def bakes(self) -> tuple[Bake, ...]:
        """Bakes of houses that the sensors need, each once; `make` adds them to the bank."""
        needed = [bake for sensor in self.sensors for bake in (sensor.keeper or sensor).bakes(self.own_config)]
        return tuple({bake.name: bake for bake in needed}.values())

    @property
    def action_names(self) -> tuple[str, ...]:
        """What the numbers of an action mean; of discrete actions, which there are."""
        return action_names(self.config)

    @property
    def action_size(self) -> int:
        """Numbers per agent, see `action_spec`; of discrete actions, how many there are to choose from."""
        return len(self.action_names)

    def bind(self, bank: HouseBank | EnvParams) -> "BoundEnv[HouseholdEnv]":
        """The environment with its parameters: `reset(key)`, `step(state, action)`.

        Raises:
            ConfigError: The houses were compiled for another body, see `check_bank`.
        """
        return BoundEnv(self, bank if isinstance(bank, EnvParams) else EnvParams(bank, self.task.task_bank(bank)))

    def reset(
        self,
        params: EnvParams,
        key: Array,
        house: Int[Array, ""] | int | None = None,
        episode: Int[Array, ""] | int | None = None,
    ) -> State:
        """A new episode.

        Args:
            params: Houses and episodes.
            key: Typed or raw uint32 key.
            house: Index of the house, the nearest one that there is if out of range; None draws one.
            episode: Row of `params.tasks`, counted around: house, start and columns come from it, the key draws the
                rest. None draws a row if there are any, by their weights if they have some.

        Returns:
            A state with its first observation, zero reward, neither terminated nor truncated.
        """
        return self.perceive(params, self.begin(params, key, house, episode))

    def step(self, params: EnvParams, state: State, action: ArrayLike) -> State:
        """One control step of `dt` seconds, then reward and observation.

        Args:
            params: Houses; may differ from the last call's as long as the bank's spec is the same.
            state: The state before.
            action: (4,), or (A, 4) for several agents that act: forward, left, turn left, look up in [-1, 1]. Others
                are clipped and NaN counts as 0, so that one bad number of a policy does not spoil an environment for
                good. Discrete: an integer, or (A,); a number that is no action does nothing. `status` tells of both.

        Returns:
            The state after. An episode that is over is not reset: see `AutoReset`.
        """
        return self.perceive(params, self.advance(params, state, action))

    def observe(self, params: EnvParams, state: State) -> State:
        """The state with its observations computed anew from the rest of it, which stays as it is."""
        snapshot = self.snapshot(params, state)
        obs = self.sense(snapshot, state, costly=True)
        return state.replace(obs=obs | self.sense(snapshot, state, costly=False))

    def perceive(self, params: EnvParams, state: State) -> State:
        """The state after its sensors were updated, once after each `begin` or `advance`; then observed."""
        snapshot = self.snapshot(params, state)
        snapshot, config = snapshot.of_first(self.num_agents), self.own_config
        kept, lost = dict(state.world.sensors), state.status
        for sensor in keepers(self.sensors):
            kept[sensor.name] = sensor.update(config, snapshot, kept[sensor.name])
            lost = lost | jnp.asarray(sensor.status(config, snapshot, kept[sensor.name]), jnp.int32)
        return self.observe(params, state.replace(world=state.world.replace(sensors=kept), status=lost))

    def sense(self, snapshot: Snapshot, state: State, costly: bool) -> dict[str, Array]:
        """Observations of the sensors that cast rays, or of the others and the task.

        Args:
            snapshot: Of all agents, see `snapshot`.
            state: The state.
            costly: Which of both.
        """
        obs: dict[str, Array] = {}
        own, config = snapshot.of_first(self.num_agents), self.own_config
        for sensor in self.sensors:
            if sensor.costly == costly:
                seen = sensor.observe(config, own, state.world.sensors[(sensor.keeper or sensor).name])
                check_observations(sensor, sensor.spec(config), seen, self.num_agents)
                obs |= seen
        if not costly:
            seen = self.task.observe(snapshot, state.task)
            check_observations(self.task, self.task.observation_spec, seen, self.config.num_agents)
            obs |= {name: value for name, value in seen.items() if name in self.observation_spec}
        return self._squeeze(obs)

    def begin(
        self,
        params: EnvParams,
        key: Array,
        house: Int[Array, ""] | int | None = None,
        episode: Int[Array, ""] | int | None = None,
    ) -> State:
        """`reset` without sensors: observations are zeros until `perceive`. For wrappers."""
        memory = {sensor.name: sensor.init(self.own_config) for sensor in keepers(self.sensors)}
        data, world, row, goal_key = first_instant(self.config, memory, params, key, house, episode)
        snapshot = self._snapshot(params, data, world)
        task = self.task.init(snapshot, goal_key, None if row is None else row.columns)
        no = jnp.zeros((), bool)
        return State(
            physics=data,
            world=world.replace(sounds=self.task.sounds(snapshot, task)),
            task=task,
            obs={name: jnp.zeros(spec.shape, spec.dtype) for name, spec in self.observation_spec.items()},
            reward=self._squeeze(jnp.zeros(self.num_agents, jnp.float32)),
            terminated=no,
            truncated=no,
            metrics=checked_metrics(self.task, self.task.metrics(snapshot, task)),
            status=lost_weights(params.tasks, episode),
            info={},
        )

    def advance(self, params: EnvParams, state: State, action: ArrayLike) -> State:
        """`step` without sensors: physics, task, reward. For wrappers.

        A step that gives poses that are no numbers is undone and ends the episode: the state stays finite, `status`
        and `World.faults` tell of it.
        """
        bank, template = params.bank, self.template(params.bank)
        moves = moves_of(self.config, action, self._stopped(state), self.num_agents)
        moves = with_noise(self.config, self._led(params, state, moves), state.world)
        before = self._use_hands(params, self._set_off(params, state, moves), moves)
        data, lost = physics.step_checked(template, bank, state.world.house, before, moves.drive)
        if self.config.hands:
            data = settle(template, bank, state.world.house, data)
        broken = physics.is_broken(data)
        data = physics.undo_where(broken, data, state.physics)
        world = state.world.replace(
            pitch=tilted(self.config, state.world.pitch, moves.look),
            stopped=moves.stop,
            said=moves.said,
            step=state.world.step + 1,
            action=moves.action,
            faults=state.world.faults + broken.astype(jnp.int32),
        )
        snapshot = self._snapshot(params, data, world)
        snapshot = snapshot.replace(sounds=self.task.sounds(snapshot, state.task))
        noises, unheard = self._noises(template, state.physics, data, snapshot)
        task = self.task.update(snapshot, state.task)
        reward, terminated = self.task.reward(snapshot, state.task, task), self.task.terminated(snapshot, task)
        metrics = checked_metrics(self.task, self.task.metrics(snapshot, task))
        check_task(self.task, state.task, task, reward, terminated, self.config.num_agents)
        reward, terminated = jnp.where(broken, 0.0, reward), terminated | broken
        return state.replace(
            physics=data,
            world=world.replace(reward=reward, sounds=snapshot.sounds, noises=noises),
            task=task,
            reward=self._squeeze(reward),
            terminated=terminated,
            truncated=(world.step >= self.config.episode_length) & ~terminated,
            metrics={**state.metrics, **metrics},  # keep what wrappers added
            status=flags(
                NOT_A_NUMBER=broken,
                STATIC_BOXES=lost.static_boxes,
                CONTACT_PAIRS=lost.contact_pairs,
                CONTACT_POINTS=lost.contact_points,
                ACTION=moves.unusable,
                NOISES=unheard,
                OUTSIDE=physics.is_outside(template, bank, state.world.house, data),
            ),
        )

    def snapshot(self, params: EnvParams, state: State) -> Snapshot:
        """The environment as tasks read it, with all agents; also for drawing."""
        return self._snapshot(params, state.physics, state.world)

    def _observation_spec(self) -> Specs:
        own = {name: spec for sensor in self.sensors for name, spec in sensor.spec(self.own_config).items()}
        offered = self.task.observation_spec
        own |= {name: offered[name] for name in self.config.sensors or () if name in offered}
        return {name: spec.for_agents(self.num_agents) for name, spec in own.items()}

    def _snapshot(self, params: EnvParams, data: Any, world: World) -> Snapshot:
        return snapshot_of(self.config, params, data, world)

    def _led(self, params: EnvParams, state: State, moves: Moves) -> Moves:
        """The moves, but of agents that the task leads."""
        if type(self.task).lead is Task.lead:
            return moves
        led = self.task.lead(self.snapshot(params, state), state.task)
        return moves if led is None else with_led(self.config, moves, self._stopped(state), *led)

    def _stopped(self, state: State) -> Any:
        """Agents that do nothing any more."""
        stopped = state.world.stopped
        return stopped if self.task.stops_for_good else jnp.zeros_like(stopped)

    def _set_off(self, params: EnvParams, state: State, moves: Moves) -> State:
        """Agents at the speed of their discrete action: it takes them exactly as far as it says."""
        if self.config.discrete is None:
            return state
        return state.replace(physics=physics.with_agent_speed(self.template(params.bank), state.physics, moves.drive))

    def _noises(self, template: physics.Template, before: Any, after: Any, snapshot: Snapshot) -> tuple[Any, Any]:
        """Those of bodies after a step, and whether any found no slot."""
        if self.config.noises is None:
            return None, jnp.zeros((), bool)
        return after_step(self.config, template, before, after, snapshot)

    def _use_hands(self, params: EnvParams, state: State, moves: Moves) -> PhysicsState:
        """The physics with hands that have been told what to do."""
        if not self.config.hands:
            return state.physics
        snapshot, template = self.snapshot(params, state), self.template(params.bank)
        commands = hand_commands(self.config, snapshot, moves.hands)
        return obey(template, params.bank, state.world.house, state.physics, commands)

    def template(self, bank: HouseBank) -> physics.Template:
        """The physics' model for banks of this capacity."""
        return template_of(self.config, bank.spec)

    def _squeeze(self, tree: Any) -> Any:
        """The border: inside are all agents; outside those that act, of whom one goes without an agent axis."""
        if self.num_agents == 1:
            return jax.tree.map(lambda x: x[0], tree)
        return tree if self.num_agents == self.config.num_agents else jax.tree.map(lambda x: x[: self.num_agents], tree)
