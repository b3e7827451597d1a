"""PiedPiper: follow the agent that emits sound, one of the tasks proposed with HoME (arXiv:1711.11017)."""

from collections.abc import Iterator
from dataclasses import dataclass, fields

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from home_mjx.core.checks import check_known, check_number
from home_mjx.navigation.grid import geodesic_distance, stored_distance
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.base.specs import Specs
from home_mjx.tasks.experts.field_descent import descend_field, is_free
from home_mjx.tasks.experts.path_follower import IDLE_TURN, to_actions, turn_towards
from home_mjx.tasks.language.vocabulary import tokenize
from home_mjx.tasks.rules.build_bank import TaskRow
from home_mjx.tasks.rules.enums import SUCCESS, Feature
from home_mjx.tasks.rules.house_view import HouseView
from home_mjx.tasks.rules.program import Condition, Selector, TaskStage, Transition
from home_mjx.tasks.rules.row_task import RowState
from home_mjx.tasks.sounds.sound_events import SoundEvent
from home_mjx.tasks.suite.audio_nav import DISTRACTOR_CLIPS, NUM_PLACES, SPLITS
from home_mjx.tasks.suite.navigation import NavigationTask

FOLLOWER, PIPER = 0, 1  # agents
ROUTE_START = 2  # index of the first of two descriptors, the ends of the piper's route
ROUTE_END_DISTANCE = 0.5  # [m] distance to the end of a route at which scripted agents turn round
SCRIPTED_IDLE_PERIOD = 3  # period in steps at which scripted agents pause
MAX_BLOCKED_STEPS = 30  # steps in contact before a blocked agent turns round, times its index
MIN_PIPER_DISTANCE = 0.9  # [m] minimum distance that the expert keeps
MAX_HEADING_ERROR = 0.15  # [rad] maximum heading error towards the piper while the expert waits
MAX_DIRECT_DISTANCE = 3.0  # [m] maximum distance at which the expert walks straight to the piper if the path is free


class PiedPiperState(RowState):
    """Task state of one episode, with the routes of the scripted agents; A agents."""

    others_route: Int[Array, "2"]  # goals of the house, the ends of the others' route
    route_end: Int[Array, " a"]  # end of its route that the agent heads for, 0 or 1
    contact_steps: Int[Array, " a"]  # number of consecutive steps in contact
    near_steps: Int[Array, ""]  # number of steps in which the follower was near the piper

    def expert(self, snapshot: Snapshot) -> Array:
        """Return the follower's action: approach the piper, see `_pursuit_point`; beside it, keep facing it."""
        pos, own = snapshot.pose.pos, jnp.array([FOLLOWER])
        waits = (jnp.linalg.norm(pos[PIPER] - pos[FOLLOWER]) < MIN_PIPER_DISTANCE)[None]
        error = turn_towards(snapshot, _pursuit_point(snapshot, self)[None], own)
        # There is no idle action, so the waiting expert turns to and fro.
        error = jnp.where(waits & (jnp.abs(error) < MAX_HEADING_ERROR), IDLE_TURN, error)
        return to_actions(snapshot.config, error, -snapshot.pose.pitch[own], waits, jnp.zeros_like(waits))


@dataclass(frozen=True)
class PiedPiper(NavigationTask):
    """Task of staying near the piper, an agent that plays sound. The task controls all agents but the first.

    The caller controls the first agent, the follower. The piper walks to and fro between two places of the house, at
    two thirds of full speed. The others do so between two places as far from the piper's as possible, and emit
    distracting sounds. Following the nearest agent may thus mean following the wrong one. The environment exposes
    actions, observations and rewards of the follower only.

    Attributes:
        num_others: Number of agents besides follower and piper, 0 or 1.
        follow_distance: Maximum distance to the piper that counts as following [m]; the first time with a free line of
            sight.
        follow_steps: Number of consecutive steps of following for success.
        clip_split: Sounds of the piper: "heard", "unheard" or "all" of `audio_nav.SPLITS`.
    """

    num_others: int = 1
    follow_distance: float = 2.0
    follow_steps: int = 80
    clip_split: str = "heard"

    def __post_init__(self) -> None:
        super().__post_init__()
        check_number("num_others", self.num_others, 0, 1, integer=True)
        check_number("follow_distance", self.follow_distance, MIN_PIPER_DISTANCE)
        check_number("follow_steps", self.follow_steps, 1, integer=True)
        check_known("split of sounds", [self.clip_split], SPLITS)

    @property
    def requires_stop(self) -> bool:
        """False: the task is to follow, not to stop."""
        return False

    @property
    def observation_spec(self) -> Specs:
        """Empty: the task adds no observations, so that the agent must rely on its sensors."""
        return {}

    @property
    def num_acting(self) -> int:
        """Number of agents that the caller controls: the follower."""
        return FOLLOWER + 1

    @property
    def min_agents(self) -> int:
        """Number of agents: follower, piper and others."""
        return 2 + self.num_others

    @property
    def max_agents(self) -> int:
        """Maximum number of agents, equal to the minimum: further agents would have no role."""
        return self.min_agents

    @property
    def num_sources(self) -> int:
        """Number of sound sources: one per agent except the follower."""
        return 1 + self.num_others

    @property
    def clips(self) -> tuple[str, ...]:
        """Sounds of the piper and of the others."""
        return (*SPLITS[self.clip_split], *(DISTRACTOR_CLIPS if self.num_others else ()))

    def rows(self, view: HouseView, random: np.random.Generator) -> Iterator[TaskRow]:
        """Yield random pairs of places as ends of the piper's route, endlessly; nothing if there are fewer than two.

        Places are centres of at most `NUM_PLACES` random cells off door leaves.
        """
        free = random.permutation(np.flatnonzero(~view.graph.at_leaf))[:NUM_PLACES]
        while len(free) > 1:
            first, second = view.graph.place[random.choice(free, 2, replace=False)].tolist()
            who = Selector.agent(PIPER + 1) if self.num_others else Selector.nothing()
            meant = [Selector.agent(PIPER), who, Selector.point(first), Selector.point(second)]
            sounds = [SoundEvent(0, str(random.choice(SPLITS[self.clip_split])))]
            sounds += [SoundEvent(1, str(random.choice(DISTRACTOR_CLIPS)))] * self.num_others
            yield TaskRow(meant, self._stages(), ROUTE_START, tokenize("follow the sound"), sounds)

    def _stages(self) -> list[TaskStage]:
        """Return two stages: until the follower is near the piper in sight; near it for `follow_steps`, or back."""
        near = Condition(Feature.STRAIGHT, 0, agent=FOLLOWER, maximum=self.follow_distance)
        clear, long = (
            Condition(Feature.CLEAR, 0, agent=FOLLOWER, minimum=1),
            Condition(Feature.TIME, minimum=self.follow_steps),
        )
        win = Transition(SUCCESS, (near, long), reward=self.success_reward)
        return [
            TaskStage((Transition(1, (near, clear)),), guide=0),
            TaskStage((win, Transition(0, forbid=(near,))), guide=0),
        ]

    def init(self, snapshot: Snapshot, key: Array, columns: dict[str, Array] | None) -> PiedPiperState:
        """Return the state in which all scripted agents head for the first end of their route."""
        agents = snapshot.pose.yaw.shape[0]
        base, zero = super().init(snapshot, key, columns), jnp.zeros(agents, jnp.int32)
        own = {option.name: getattr(base, option.name) for option in fields(RowState)}
        stray = _far_goals(snapshot, base.program.place[ROUTE_START : ROUTE_START + 2])
        return PiedPiperState(**own, others_route=stray, route_end=zero, contact_steps=zero, near_steps=zero[0])

    def control_agents(self, snapshot: Snapshot, state: PiedPiperState) -> tuple[Bool[Array, " a"], Array]:
        """Return the mask of scripted agents and their actions: down the distance field, idle every third step."""
        pose, config = snapshot.pose, snapshot.config
        everybody = jnp.ones_like(snapshot.stopped)
        error = turn_towards(snapshot, _next_points(snapshot, state))
        actions = to_actions(config, error, -pose.pitch, ~everybody, ~everybody)
        rests = snapshot.step % SCRIPTED_IDLE_PERIOD == 0
        nothing = (
            jnp.zeros_like(actions) if config.discrete is None else jnp.full_like(actions, len(config.action_names))
        )
        return jnp.arange(len(everybody)) != FOLLOWER, jnp.where(rests, nothing, actions)

    def update(self, snapshot: Snapshot, state: PiedPiperState) -> PiedPiperState:
        """Update the row's state and `near_steps`; scripted agents that have arrived or are blocked turn round."""
        new = super().update(snapshot, state)
        assert isinstance(new, PiedPiperState)
        blocked = jnp.where(snapshot.in_contact, state.contact_steps + 1, 0)
        left = _remaining_lengths(snapshot, state)
        # Agents turn at different times: the first one needs time to turn and move away.
        turns = (left < ROUTE_END_DISTANCE) | (blocked >= MAX_BLOCKED_STEPS * jnp.arange(len(blocked)))
        near = (new.distance[FOLLOWER, 0] <= jnp.float32(self.follow_distance)).astype(jnp.int32)
        return new.replace(
            route_end=jnp.where(turns, 1 - state.route_end, state.route_end),
            contact_steps=jnp.where(turns, 0, blocked),
            near_steps=state.near_steps + near,
        )

    def observe(self, snapshot: Snapshot, state: PiedPiperState) -> dict[str, Array]:
        """Return an empty dictionary."""
        return {}

    def reward_terms(
        self, snapshot: Snapshot, before: PiedPiperState, state: PiedPiperState
    ) -> dict[str, Float[Array, " a"]]:
        """Return the terms of the follower's reward; 0 for all other agents."""
        terms = super().reward_terms(snapshot, before, state)
        is_follower = jnp.arange(snapshot.pose.yaw.shape[0]) == FOLLOWER
        return {name: jnp.where(is_follower, term, 0.0) for name, term in terms.items()}

    def metrics(self, snapshot: Snapshot, state: PiedPiperState) -> dict[str, Float[Array, ""]]:
        """Return success, distance to the piper [m], fraction of steps near it, collisions and stage."""
        steps = jnp.maximum(snapshot.step, 1).astype(jnp.float32)
        return {
            "success": (state.stage == SUCCESS).astype(jnp.float32),
            "distance": state.distance[FOLLOWER, 0],
            "near": state.near_steps.astype(jnp.float32) / steps,
            "collisions": state.collisions[FOLLOWER].astype(jnp.float32),
            "stage": state.stage.astype(jnp.float32),
        }


def _far_goals(snapshot: Snapshot, route: Float[Array, "2 3"]) -> Int[Array, "2"]:
    """Return two goals of the house: the farthest from both ends of a route, then the farthest from these three.

    Far is the distance to the nearest of them; of equally far goals the first counts.
    """
    bank, house = snapshot.bank, snapshot.house
    to_goals = jax.vmap(lambda end: geodesic_distance(bank, house, None, end))(route)
    first = jnp.argmax(jnp.min(to_goals, axis=0))
    from_first = geodesic_distance(bank, house, None, bank.navigation.goal[house, first])
    return jnp.stack([first, jnp.argmax(jnp.minimum(jnp.min(to_goals, axis=0), from_first))]).astype(jnp.int32)


def _route_columns(state: PiedPiperState) -> Int[Array, "2"]:
    """Return the columns of `TaskBank.field` for both ends of the piper's route."""
    return jnp.maximum(state.program.field[ROUTE_START : ROUTE_START + 2], 0).astype(jnp.int32)


def _destination_columns(state: PiedPiperState) -> tuple[Int[Array, " a"], Int[Array, " a"]]:
    """Return each agent's destination twice: as column of the task bank's fields, and of the house's fields.

    The first is valid for the piper, the second for the others.
    """
    return _route_columns(state)[state.route_end], state.others_route[state.route_end]


def _pursuit_point(snapshot: Snapshot, state: PiedPiperState) -> Float[Array, "2"]:
    """Return the point (x, y) [m] that the follower walks straight to on its way to the piper.

    That is the piper, if it is within `MAX_DIRECT_DISTANCE` and the path is free. Otherwise it is the next point on the
    path to one end of the piper's route: the end that the piper heads for, if the follower is farther from it than the
    piper and so gets behind it; else the other, from which the piper comes to meet it.
    """
    pos, feet, field = snapshot.pose.pos, snapshot.feet, snapshot.tasks.field
    ends = _route_columns(state)
    to, come = ends[state.route_end[PIPER]], ends[1 - state.route_end[PIPER]]
    left = [geodesic_distance(snapshot.bank, snapshot.house, to, feet[who], field) for who in (FOLLOWER, PIPER)]
    column = jnp.where(left[0] > left[1], to, come)
    aim, _ = descend_field(snapshot, jnp.int32(FOLLOWER), lambda _, cell: stored_distance(field, cell, column))
    is_close = jnp.linalg.norm(pos[PIPER] - pos[FOLLOWER]) < MAX_DIRECT_DISTANCE
    straight = is_close & is_free(snapshot, jnp.int32(FOLLOWER), feet[PIPER])
    return jnp.where(straight, pos[PIPER, :2], aim)


def _remaining_lengths(snapshot: Snapshot, state: PiedPiperState) -> Float[Array, " a"]:
    """Return the path length from each agent to the end that it heads for [m]; the follower's has no meaning."""

    def path_length(feet: Array, column: Array, field: Array | None) -> Array:
        """Return the path length from feet to the goal of a column [m]; None: the house's fields."""
        return geodesic_distance(snapshot.bank, snapshot.house, column, feet, field)

    own, stray = _destination_columns(state)
    feet = snapshot.feet
    piper = path_length(feet[PIPER], own[PIPER], snapshot.tasks.field)
    return jax.vmap(lambda at, column: path_length(at, column, None))(feet, stray).at[PIPER].set(piper)


def _next_points(snapshot: Snapshot, state: PiedPiperState) -> Float[Array, "a 2"]:
    """Return the point (x, y) that each agent walks straight to on its path [m]; the follower's has no meaning."""
    own, stray = _destination_columns(state)
    fields_ = snapshot.tasks.field, snapshot.bank.navigation.field

    def one(agent: Array) -> Array:
        """Return the point of one agent."""

        def far(_: Array, cell: Array) -> Array:
            """Return distances of cells to the agent's destination [m]."""
            piper, other = (stored_distance(f, cell, c[agent]) for f, c in zip(fields_, (own, stray), strict=True))
            return jnp.where(agent == PIPER, piper, other)

        return descend_field(snapshot, agent, far)[0]

    return jax.vmap(one)(jnp.arange(snapshot.config.num_agents))
