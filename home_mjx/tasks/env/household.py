"""The environment: houses, physics, sensors and a task in one jitted step."""

from typing import Any

import jax
import jax.numpy as jnp
from jax.typing import ArrayLike
from jaxtyping import Array, Bool, Int

from home_mjx import physics
from home_mjx.bank.bank import HouseBank
from home_mjx.core.compile_cache import describe_compile
from home_mjx.core.progress import say
from home_mjx.errors import ConfigError
from home_mjx.houses.bakes import Bake, find_bake
from home_mjx.physics import PhysicsState
from home_mjx.physics.hand_control import apply_hand_commands, update_hands
from home_mjx.tasks.base.config import EnvConfig
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.base.specs import HAND_NAMES, Specs
from home_mjx.tasks.base.state import EnvParams, State, World
from home_mjx.tasks.base.status import add_flags, status_flags
from home_mjx.tasks.base.task import Task
from home_mjx.tasks.contact_sounds.update import update_contact_sounds
from home_mjx.tasks.env.actions import (
    DecodedActions,
    action_names,
    action_spec,
    apply_move_noise,
    decode_actions,
    override_moves,
    spoken_tokens,
    update_pitch,
)
from home_mjx.tasks.env.checks import check_metrics, check_observations, check_state, check_task, check_task_options
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.hand_actions import decode_hand_commands
from home_mjx.tasks.env.reset import build_snapshot, init_physics_and_world, physics_template, put_bodies, weights_flag
from home_mjx.tasks.env.toggle_actions import toggle_switches
from home_mjx.tasks.sensors.selection import resolve_sensor_names, select_sensors, state_owners
from home_mjx.tasks.suite.point_nav import PointNav
from home_mjx.tasks.switches.sounds import SWITCH_CLIPS, play_switched


class HouseholdEnv:
    """Agents in houses: the core, whose functions take `EnvParams` first. Each is for one environment: use `jax.vmap`.

    `reset(params, key)`, `step(params, state, action)` and `observe(params, state)` return the same tree. The bank is
    an argument, never a constant of the compiled program. `bind(bank)` returns a `Env` with `reset(key)` and
    `step(state, action)`.

    Args:
        config: Options, see `EnvConfig`.
        task: The task.

    Attributes:
        config: The options, with resolved sensor names.
        task: The task.
        acting_config: The options restricted to the acting agents, as passed to sensors.
        sensors: The sensors, without those of the task.
        progress: Say on stderr that `reset` or `step` compiles, once each; None: by the rule of
            `home_mjx.core.progress`.
        action_spec: Forward, left, turn left, look up: each in [-1, 1], as a fraction of its maximum rate. Discrete:
            the index of one of `action_names`.
        observation_spec: Specs of `State.obs` by name; with a leading agent axis if several agents act.

    Raises:
        ConfigError: A sensor or a word is unknown, or two observations have the same name. Or the task does not fit the
            actions or the number of agents.

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
        check_task_options(config, self.task)
        self.config = config.replace(
            sensors=resolve_sensor_names(config, self.task),
            num_sources=max(config.num_sources, self.task.num_sources),
            clips=tuple(dict.fromkeys((*config.clips, *self.task.clips, *(SWITCH_CLIPS if config.switches else ())))),
            speech=tuple(dict.fromkeys((*config.speech, *self.task.speech))),
        )
        self.acting_config = self.config.select_agents(self.num_agents)
        self.sensors = select_sensors(self.acting_config, self.task)
        self.progress: bool | None = None
        self._announced: set[str] = set()
        spoken_tokens(self.config)  # raises for words that the language lacks
        self.action_spec = action_spec(self.acting_config)
        self.observation_spec = self._observation_spec()

    @property
    def num_agents(self) -> int:
        """Number of acting agents per environment: those with actions, observations and rewards.

        Excludes agents that the task controls, see `Task.num_acting`; `config.num_agents` counts these as well.
        """
        return self.task.num_acting or self.config.num_agents

    @property
    def dt(self) -> float:
        """Control step [s]."""
        return self.config.timing.ctrl_dt

    @property
    def bakes(self) -> tuple[Bake, ...]:
        """Bakes of houses that sensors and shaders need, each once; `make` adds them to the bank.

        A sensor gives the bake with its options. A shader names it, which selects the sensor's or the default options.
        """
        config = self.acting_config
        needed = [bake for sensor in self.sensors for bake in (sensor.state_owner or sensor).bakes(config)]
        by_name = {bake.name: bake for bake in needed}
        names = [name for shader in config.shaders for name in shader.needs if name not in by_name]
        return (*by_name.values(), *(find_bake(name) for name in dict.fromkeys(names)))

    @property
    def action_names(self) -> tuple[str, ...]:
        """Names of the elements of a continuous action, or of the discrete actions."""
        return action_names(self.config)

    @property
    def action_size(self) -> int:
        """Number of elements of an action per agent, see `action_spec`; for discrete actions their number."""
        return len(self.action_names)

    def bind(self, bank: HouseBank | EnvParams) -> "Env[HouseholdEnv]":
        """Return the environment with its parameters; a bank gets the rows of the task's `task_bank`.

        `EnvParams` are used as they are, so that their `tasks` may be None.

        Raises:
            ConfigError: The houses were compiled for another body, see `check_bank`; or as the task's `task_bank`. Or
                tasks, sounds or variation do not fit the environment, see `check_tasks`.
        """
        return Env(self, bank if isinstance(bank, EnvParams) else EnvParams(bank, self.task.task_bank(bank)))

    def reset(
        self,
        params: EnvParams,
        key: Array,
        house: Int[Array, ""] | int | None = None,
        episode: Int[Array, ""] | int | None = None,
        *,
        observe: bool = True,
    ) -> State:
        """Start a new episode.

        Args:
            params: Houses and episodes.
            key: Typed or raw uint32 key.
            house: Index of the house, clipped to the bank; None samples one. None is required with `params.tasks`.
            episode: Row of `params.tasks`, modulo their number: house, columns and the first agent's start come from
                it, the rest from the key. None samples a row if there are any, by weight if they have weights.
            observe: If False, no sensor runs and observations are 0; `observe(params, state, update=True)` adds them.

        Returns:
            A state with its first observation, zero reward, neither terminated nor truncated.

        Raises:
            ConfigError: `house` is given although `params.tasks` has rows, or `episode` although it has none; or `key`
                is not one key.
        """
        self._announce_compile("reset", key)
        state, snapshot = self._init(params, key, house, episode)
        return self._observe(state, snapshot, update=True) if observe else state

    def step(self, params: EnvParams, state: State, action: ArrayLike, *, observe: bool = True) -> State:
        """Run one control step of `dt` seconds, then compute reward and observation.

        Args:
            params: Houses; may differ from the last call's if the bank's spec is the same.
            state: The state before.
            action: (4,), or (A, 4) for several acting agents: forward, left, turn left, look up in [-1, 1]. Other
                values are clipped and NaN counts as 0, so that one bad output of a policy does not corrupt an
                environment for good. Discrete: an integer, or (A,); inside `jit` or `vmap` an invalid one does nothing.
                `status` flags both.
            observe: If False, no sensor runs and observations stay those of `state`; `observe(params, state,
                update=True)` renews them.

        Returns:
            The state after. An episode that is over is not reset: see `AutoReset`; `status` has the flag `OVER` then. A
            step that leads to a pose that is not finite is undone and ends the episode. The state stays finite;
            `status` and `World.num_faults` record the fault. A state of another house, such as one of another bank,
            ends with reward 0 and the flag `OTHER_HOUSE`.

        Raises:
            ConfigError: The state is of another bank, as far as shapes or, outside of `jit` and `vmap`, values tell. Or
                the action has another shape or type.
            OutOfRangeError: A discrete action does not exist, outside of `jit` and `vmap`.
        """
        self._announce_compile("step", state.status)
        state, snapshot = self._advance(params, state, action)
        return self._observe(state, snapshot, update=True) if observe else state

    def observe(self, params: EnvParams, state: State, *, update: bool = False) -> State:
        """Return the state with observations recomputed from its other fields.

        Args:
            params: Houses.
            state: The state.
            update: If True, sensor states are updated first. Do so exactly once after a `reset` or `step` with
                `observe=False`. False: all other fields stay as they are.
        """
        return self._observe(state, self.snapshot(params, state), update=update)

    def snapshot(self, params: EnvParams, state: State) -> Snapshot:
        """Return all agents, bodies and sounds at the instant of `state`, as tasks read them and films draw them."""
        return build_snapshot(self.config, params, state.physics, state.world)

    def template(self, bank: HouseBank) -> physics.Template:
        """Return the physics template of a bank: the model that all houses of its capacity share; cached."""
        return physics_template(self.config, bank.spec)

    def _announce_compile(self, name: str, argument: Any) -> None:
        """Print on stderr, once per `name`, that this function compiles; only if `argument` is traced.

        What `progress` suppresses is not printed, and may be printed later.
        """
        is_traced = isinstance(argument, jax.core.Tracer)  # pyright: ignore[reportAttributeAccessIssue]
        if is_traced and name not in self._announced and say(describe_compile(name), self.progress):
            self._announced.add(name)

    def _init(
        self,
        params: EnvParams,
        key: Array,
        house: Int[Array, ""] | int | None = None,
        episode: Int[Array, ""] | int | None = None,
    ) -> tuple[State, Snapshot]:
        """Return the first state of an episode with zero observations and sensors not yet updated, and its snapshot."""
        memory = {sensor.name: sensor.init(self.acting_config) for sensor in state_owners(self.sensors)}
        data, world, row, goal_key = init_physics_and_world(self.config, memory, params, key, house, episode)
        columns, snapshot = None if row is None else row.columns, build_snapshot(self.config, params, data, world)
        if world.switch_on is not None:
            world = world.replace(switch_on=self.task.start_switches(snapshot, columns))
            snapshot = build_snapshot(self.config, params, data, world)
        if not params.bank.compartments.is_empty:
            data = put_bodies(self.config, params.bank, data, self.task.start_bodies(snapshot, columns))
            snapshot = build_snapshot(self.config, params, data, world)
        task, no = self.task.init(snapshot, goal_key, columns), jnp.zeros((), bool)
        sounds, unheard = play_switched(snapshot, self.task.sounds(snapshot, task))
        state = State(
            physics=data,
            world=world.replace(sounds=sounds),
            task=task,
            obs={name: jnp.zeros(spec.shape, spec.dtype) for name, spec in self.observation_spec.items()},
            reward=self._select_acting(jnp.zeros(self.num_agents, jnp.float32)),
            terminated=no,
            truncated=no,
            metrics=check_metrics(self.task, self.task.metrics(snapshot, task)),
            status=add_flags(weights_flag(params.tasks, episode), unheard),
            info={},
        )
        return state, snapshot.replace(sounds=sounds)

    def reward_terms(self, params: EnvParams, before: State, after: State) -> dict[str, Array]:
        """Return the task's terms of the reward of a step, with the shape of `State.reward`; {} if it has none (JAX).

        Args:
            params: Arrays of the environment.
            before: State before the step.
            after: State after it, before an automatic reset.
        """
        terms = self.task.reward_terms(self.snapshot(params, after), before.task, after.task)
        return {name: self._select_acting(term) for name, term in terms.items()}

    def _advance(self, params: EnvParams, state: State, action: ArrayLike) -> tuple[State, Snapshot]:
        """Return the next state, with observations and sensor states of the last one, and its snapshot.

        A step to a pose that is not finite is undone. This, or a state of another house, ends the episode with reward
        0. From step `episode_length` on it is truncated, unless it is terminated.
        """
        bank, template = params.bank, self.template(params.bank)
        check_state(template.layout, params, state)
        moves, start, switch_on = self._apply_action(params, state, action)
        is_over = state.done & (state.world.step > 0)  # after an automatic reset `done` is of the episode before
        is_foreign = bank.fingerprint(state.world.house) != state.world.house_fingerprint
        data, lost = physics.step_checked(template, bank, state.world.house, start, moves.drive)
        if self.config.hands:
            data = update_hands(template, bank, state.world.house, data)
        broken = physics.is_unstable(data)
        data = physics.undo_where(broken, data, state.physics)
        world = self._next_world(state.world, moves, switch_on, broken)
        snapshot = build_snapshot(self.config, params, data, world)
        sounds, unplayed = play_switched(snapshot, self.task.sounds(snapshot, state.task))
        snapshot = snapshot.replace(sounds=sounds)
        noises, unheard = self._contact_sounds(template, state.physics, data, snapshot)
        task = self.task.update(snapshot, state.task)
        reward, terminated = self.task.reward(snapshot, state.task, task), self.task.terminated(snapshot, task)
        metrics = check_metrics(self.task, self.task.metrics(snapshot, task))
        check_task(self.task, state.task, task, reward, terminated, self.config.num_agents)
        reward, terminated = jnp.where(broken | is_foreign, 0.0, reward), terminated | broken | is_foreign
        state = state.replace(
            physics=data,
            world=world.replace(reward=reward, sounds=snapshot.sounds, contact_sounds=noises),
            task=task,
            reward=self._select_acting(reward),
            terminated=terminated,
            truncated=(world.step >= self.config.episode_length) & ~terminated,
            metrics={**state.metrics, **metrics},  # keep entries of wrappers
            status=add_flags(
                status_flags(
                    NOT_A_NUMBER=broken,
                    STATIC_BOXES=lost.static_boxes,
                    CONTACT_PAIRS=lost.contact_pairs,
                    CONTACT_POINTS=lost.contact_points,
                    ACTION=moves.is_invalid,
                    NOISES=unheard,
                    OUTSIDE=physics.is_out_of_bounds(template, bank, state.world.house, data),
                    OVER=is_over,
                    OTHER_HOUSE=is_foreign,
                ),
                unplayed,
            ),
        )
        return state, snapshot.replace(reward=reward, contact_sounds=noises)

    def _observe(self, state: State, snapshot: Snapshot, *, update: bool) -> State:
        """Return the state with observations from its snapshot (of all agents).

        With `update`, sensor states are updated first; the snapshot holds none of them.
        """
        state = self._update_sensors(state, snapshot) if update else state
        return state.replace(obs=self._observations(state, snapshot))

    def _update_sensors(self, state: State, snapshot: Snapshot) -> State:
        """Return the state with updated sensor states; their flags are added to its status."""
        own, config = snapshot.select_agents(self.num_agents), self.acting_config
        kept, lost = dict(state.world.sensor_states), state.status
        for sensor in state_owners(self.sensors):
            kept[sensor.name] = sensor.update(config, own, kept[sensor.name])
            lost = lost | jnp.asarray(sensor.status(config, own, kept[sensor.name]), jnp.int32)
        return state.replace(world=state.world.replace(sensor_states=kept), status=lost)

    def _observations(self, state: State, snapshot: Snapshot, *, cast_rays: bool = True) -> dict[str, Array]:
        """Return the acting agents' observations by name; without an agent axis if one agent acts.

        They are of sensors, task and `_extra_observations`. Those of the task that `observation_spec` lacks are
        dropped. Without `cast_rays`, sensors that cast rays are left out.
        """
        obs: dict[str, Array] = {}
        own, config = snapshot.select_agents(self.num_agents), self.acting_config
        for sensor in self.sensors:
            if cast_rays or not sensor.casts_rays:
                seen = sensor.observe(config, own, state.world.sensor_states[(sensor.state_owner or sensor).name])
                check_observations(sensor, sensor.spec(config), seen, self.num_agents)
                obs |= seen
        seen = self.task.observe(snapshot, state.task)
        check_observations(self.task, self.task.observation_spec, seen, self.config.num_agents)
        obs |= {name: value for name, value in seen.items() if name in self.observation_spec}
        return self._select_acting(obs | self._extra_observations(state, snapshot))

    def _extra_observations(self, state: State, snapshot: Snapshot) -> dict[str, Array]:
        """Return observations that a subclass adds, by name, each with a leading axis of all agents; none here."""
        return {}

    def _observation_spec(self) -> Specs:
        """Return specs by name of sensors and of those task observations that `config.sensors` names.

        They are for the acting agents: with a leading axis of these if there are several, without it for one.
        """
        own = {name: spec for sensor in self.sensors for name, spec in sensor.spec(self.acting_config).items()}
        offered = self.task.observation_spec
        own |= {name: offered[name] for name in self.config.sensors or () if name in offered}
        return {name: spec.for_agents(self.num_agents) for name, spec in own.items()}

    def _apply_action(
        self, params: EnvParams, state: State, action: ArrayLike
    ) -> tuple[DecodedActions, PhysicsState, Any]:
        """Return the decoded actions, the physics state with their hand commands, before the step, and switch states.

        Actions of agents that the task controls replace the caller's, then move noise is added. Discrete moves also set
        the agents' speeds at once.
        """
        moves = decode_actions(self.config, action, self._idle_agents(state), self.num_agents)
        controls_agents = type(self.task).control_agents is not Task.control_agents
        before = self.snapshot(params, state) if controls_agents or self.config.hands else None
        if before is not None and controls_agents:
            led = self.task.control_agents(before, state.task)
            moves = moves if led is None else override_moves(self.config, moves, self._idle_agents(state), *led)
        moves = apply_move_noise(self.config, moves, state.world)
        start, template, switch_on = state.physics, self.template(params.bank), state.world.switch_on
        if self.config.discrete is not None:  # each move then covers exactly its distance
            start = physics.with_agent_speed(template, start, moves.drive)
        if before is not None and self.config.hands:
            commands = decode_hand_commands(self.config, before, moves.hands[:, : len(HAND_NAMES)])
            start = apply_hand_commands(template, params.bank, state.world.house, start, commands)
            if switch_on is not None:
                switch_on = toggle_switches(self.config, before, moves.hands[:, len(HAND_NAMES)], switch_on)
        return moves, start, switch_on

    def _next_world(self, world: World, moves: DecodedActions, switch_on: Any, broken: Bool[Array, ""]) -> World:
        """Return the world after a step with decoded `moves` and new states `switch_on`.

        `sounds` and `reward` are still those before it. A `broken` step counts as a fault, and its pitch, stops,
        words and states of switches are kept.
        """
        return world.replace(
            pitch=update_pitch(self.config, world.pitch, moves.look),
            stopped=moves.stopped,
            spoken_token=moves.spoken_token,
            step=world.step + 1,
            action=moves.action,
            num_faults=world.num_faults + broken.astype(jnp.int32),
            switch_on=None if world.switch_on is None else jnp.where(broken, world.switch_on, switch_on),
        )

    def _idle_agents(self, state: State) -> Any:
        """Return a mask of agents that have stopped and stay idle; all False if the task's `stop_is_final` is False."""
        stopped = state.world.stopped
        return stopped if self.task.stop_is_final else jnp.zeros_like(stopped)

    def _contact_sounds(
        self, template: physics.Template, before: Any, after: Any, snapshot: Snapshot
    ) -> tuple[Any, Any]:
        """Return the contact sounds after a step (None if disabled), and whether one found no free slot."""
        if self.config.contact_sounds is None:
            return None, jnp.zeros((), bool)
        return update_contact_sounds(self.config, template, before, after, snapshot)

    def _select_acting(self, tree: Any) -> Any:
        """Return arrays of the acting agents only, the first rows; a single one loses the agent axis."""
        if self.num_agents == 1:
            return jax.tree.map(lambda x: x[0], tree)
        return tree if self.num_agents == self.config.num_agents else jax.tree.map(lambda x: x[: self.num_agents], tree)
