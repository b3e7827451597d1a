"""PiedPiper: follow the one who sounds, one of the tasks that HoME was made for (arXiv:1711.11017)."""

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
from home_mjx.tasks.experts.descent import descend, is_free
from home_mjx.tasks.experts.walk import ON_THE_SPOT, to_actions, turn_towards
from home_mjx.tasks.language.vocabulary import tokenize
from home_mjx.tasks.rules.build import Row
from home_mjx.tasks.rules.house_view import HouseView
from home_mjx.tasks.rules.program import Go, Meant, Stage, When
from home_mjx.tasks.rules.row_task import RowState
from home_mjx.tasks.rules.words import SUCCESS, Feature
from home_mjx.tasks.sounds.row import Sound
from home_mjx.tasks.suite.audio_nav import DISTRACTING, NUM_PLACES, SPLITS
from home_mjx.tasks.suite.navigation import Navigation

FOLLOWER, PIPER = 0, 1  # agents
ROUTE = 2  # first of the two descriptors between which the piper walks
THERE = 0.5  # [m]: then they turn round
PACE = 3  # every so many steps who is led rests
PATIENCE = 30  # steps in touch with something, after which the first of them turns round as well; the next later
APART = 0.9  # [m]: the expert comes no nearer
LOOKS = 0.15  # [rad]: who waits looks at the piper so nearly
CLOSE = 3.0  # [m]: if the piper is so near, the expert walks straight to it where the way is free


class PiedPiperState(RowState):
    """Where an episode stands, and where those who are led are going; A agents."""

    stray: Int[Array, "2"]  # the house's goals between which the others walk
    heading: Int[Array, " a"]  # 0 or 1: to which end of its route
    blocked: Int[Array, " a"]  # steps in touch with something, one after the other
    near: Int[Array, ""]  # steps in which the follower was near

    def expert(self, snapshot: Snapshot) -> Array:
        """The follower's: towards the piper, see `_chase`; beside it, it keeps an eye on the piper."""
        pos, own = snapshot.pose.pos, jnp.array([FOLLOWER])
        waits = (jnp.linalg.norm(pos[PIPER] - pos[FOLLOWER]) < APART)[None]
        error = turn_towards(snapshot, _chase(snapshot, self)[None], own)
        # No action does nothing: who waits looks to and fro.
        error = jnp.where(waits & (jnp.abs(error) < LOOKS), ON_THE_SPOT, error)
        return to_actions(snapshot.config, error, -snapshot.pose.pitch[own], waits, jnp.zeros_like(waits))


@dataclass(frozen=True)
class PiedPiper(Navigation):
    """Stay near the agent that plays. The task itself leads that one, and the others, which make other noises.

    The first agent is yours. The second, the piper, walks to and fro between two places of the house, at two thirds of
    the speed. So do the others, between two places that are as far from the piper's as the house has them: whoever
    follows the nearest agent may follow the wrong one. Outwardly there is your agent alone: its action, its
    observations, its reward.

    Attributes:
        others: So many agents beside the piper, 0 or 1.
        follow_distance: Near is so near to the piper [m], at first with nothing between.
        follow_steps: So many steps one after the other.
        clip_split: What the piper plays: "heard", "unheard" or "all" of `audio_nav.SPLITS`.
    """

    others: int = 1
    follow_distance: float = 2.0
    follow_steps: int = 80
    clip_split: str = "heard"

    def __post_init__(self) -> None:
        super().__post_init__()
        check_number("others", self.others, 0, 1, whole=True)
        check_number("follow_distance", self.follow_distance, APART)
        check_number("follow_steps", self.follow_steps, 1, whole=True)
        check_known("split of sounds", [self.clip_split], SPLITS)

    @property
    def needs_stop(self) -> bool:
        """No."""
        return False

    @property
    def observation_spec(self) -> Specs:
        """None: what there is to know is heard and seen."""
        return {}

    @property
    def num_acting(self) -> int:
        """The follower."""
        return FOLLOWER + 1

    @property
    def least_agents(self) -> int:
        """The follower, the piper and the others."""
        return 2 + self.others

    @property
    def most_agents(self) -> int:
        """No more than it needs: whoever else there is would stand still and be in nobody's row."""
        return self.least_agents

    @property
    def num_sources(self) -> int:
        """Everybody's but the follower's."""
        return 1 + self.others

    @property
    def clips(self) -> tuple[str, ...]:
        """The piper's, and the others' noises."""
        return (*SPLITS[self.clip_split], *(DISTRACTING if self.others else ()))

    def rows(self, view: HouseView, random: np.random.Generator) -> Iterator[Row]:
        """Pairs of places of the house."""
        free = random.permutation(np.flatnonzero(~view.graph.at_leaf))[:NUM_PLACES]
        while len(free) > 1:
            first, second = view.graph.place[random.choice(free, 2, replace=False)].tolist()
            who = Meant.someone(PIPER + 1) if self.others else Meant.hidden()
            meant = [Meant.someone(PIPER), who, Meant.at(first), Meant.at(second)]
            sounds = [Sound(0, str(random.choice(SPLITS[self.clip_split])))]
            sounds += [Sound(1, str(random.choice(DISTRACTING)))] * self.others
            yield Row(meant, self._stages(), ROUTE, tokenize("follow the sound"), sounds)

    def _stages(self) -> list[Stage]:
        near = When(Feature.STRAIGHT, 0, agent=FOLLOWER, most=self.follow_distance)
        clear, long = When(Feature.CLEAR, 0, agent=FOLLOWER, least=1), When(Feature.TIME, least=self.follow_steps)
        win = Go(SUCCESS, (near, long), reward=self.success_reward)
        return [Stage((Go(1, (near, clear)),), guide=0), Stage((win, Go(0, bars=(near,))), guide=0)]

    def init(self, snapshot: Snapshot, key: Array, columns: dict[str, Array] | None) -> PiedPiperState:
        """Everybody sets out to the first end of their route."""
        agents = snapshot.pose.yaw.shape[0]
        base, zero = super().init(snapshot, key, columns), jnp.zeros(agents, jnp.int32)
        own = {option.name: getattr(base, option.name) for option in fields(RowState)}
        stray = _far_goals(snapshot, base.program.place[ROUTE : ROUTE + 2])
        return PiedPiperState(**own, stray=stray, heading=zero, blocked=zero, near=zero[0])

    def lead(self, snapshot: Snapshot, state: PiedPiperState) -> tuple[Bool[Array, " a"], Array]:
        """The piper and the others, down the distances to where they are going, but for every third step."""
        pose, config = snapshot.pose, snapshot.config
        everybody = jnp.ones_like(snapshot.stopped)
        error = turn_towards(snapshot, _aims(snapshot, state))
        actions = to_actions(config, error, -pose.pitch, ~everybody, ~everybody)
        rests = snapshot.step % PACE == 0
        nothing = (
            jnp.zeros_like(actions) if config.discrete is None else jnp.full_like(actions, len(config.action_names))
        )
        return jnp.arange(len(everybody)) != FOLLOWER, jnp.where(rests, nothing, actions)

    def update(self, snapshot: Snapshot, state: PiedPiperState) -> PiedPiperState:
        """The next stage; and who has arrived, or cannot go on, turns round."""
        new = super().update(snapshot, state)
        assert isinstance(new, PiedPiperState)
        blocked = jnp.where(snapshot.contact, state.blocked + 1, 0)
        left = _left(snapshot, state)
        # Not both at once: the first needs the time to turn and to go.
        turns = (left < THERE) | (blocked >= PATIENCE * jnp.arange(len(blocked)))
        near = (new.distance[FOLLOWER, 0] <= jnp.float32(self.follow_distance)).astype(jnp.int32)
        return new.replace(
            heading=jnp.where(turns, 1 - state.heading, state.heading),
            blocked=jnp.where(turns, 0, blocked),
            near=state.near + near,
        )

    def observe(self, snapshot: Snapshot, state: PiedPiperState) -> dict[str, Array]:
        """Nothing."""
        return {}

    def reward(self, snapshot: Snapshot, before: PiedPiperState, state: PiedPiperState) -> Float[Array, " a"]:
        """The follower's: progress towards the piper, success, less costs."""
        reward = super().reward(snapshot, before, state)
        return jnp.where(jnp.arange(len(reward)) == FOLLOWER, reward, 0.0)

    def metrics(self, snapshot: Snapshot, state: PiedPiperState) -> dict[str, Float[Array, ""]]:
        """Success, distance from the follower to the piper [m], part of the steps near it, collisions, stage."""
        steps = jnp.maximum(snapshot.step, 1).astype(jnp.float32)
        return {
            "success": (state.stage == SUCCESS).astype(jnp.float32),
            "distance": state.distance[FOLLOWER, 0],
            "near": state.near.astype(jnp.float32) / steps,
            "collisions": state.collisions[FOLLOWER].astype(jnp.float32),
            "stage": state.stage.astype(jnp.float32),
        }


def _far_goals(snapshot: Snapshot, route: Float[Array, "2 3"]) -> Int[Array, "2"]:
    """Two of the house's goals: that which is farthest from both ends of a route, and then from these and the first."""
    bank, house = snapshot.bank, snapshot.house
    to_goals = jax.vmap(lambda end: geodesic_distance(bank, house, None, end))(route)
    first = jnp.argmax(jnp.min(to_goals, axis=0))
    from_first = geodesic_distance(bank, house, None, bank.navigation.goal[house, first])
    return jnp.stack([first, jnp.argmax(jnp.minimum(jnp.min(to_goals, axis=0), from_first))]).astype(jnp.int32)


def _ends(state: PiedPiperState) -> Int[Array, "2"]:
    """Columns of the task bank's fields: distances to both ends of the piper's route."""
    return jnp.maximum(state.program.field[ROUTE : ROUTE + 2], 0).astype(jnp.int32)


def _columns(state: PiedPiperState) -> tuple[Int[Array, " a"], Int[Array, " a"]]:
    """Where each agent is heading to: column of the task bank's fields for the piper, of the house's for the others."""
    return _ends(state)[state.heading], state.stray[state.heading]


def _chase(snapshot: Snapshot, state: PiedPiperState) -> Float[Array, "2"]:
    """Where the follower walks straight on its way to the piper [m].

    That is the piper, if it is close and the way is free. Else it is the way to one end of the piper's route: to that
    which the piper walks to, if the follower has farther to go there, and so gets behind it; or else to the other one,
    from which the piper comes to meet it. So no field of distances to where the piper is need be made.
    """
    pos, field = snapshot.pose.pos, snapshot.tasks.field
    ends = _ends(state)
    to, come = ends[state.heading[PIPER]], ends[1 - state.heading[PIPER]]
    left = [geodesic_distance(snapshot.bank, snapshot.house, to, pos[who], field) for who in (FOLLOWER, PIPER)]
    column = jnp.where(left[0] > left[1], to, come)
    aim, _ = descend(snapshot, jnp.int32(FOLLOWER), lambda _, cell: stored_distance(field, cell, column))
    is_close = jnp.linalg.norm(pos[PIPER] - pos[FOLLOWER]) < CLOSE
    straight = is_close & is_free(snapshot, jnp.int32(FOLLOWER), pos[PIPER])
    return jnp.where(straight, pos[PIPER, :2], aim)


def _left(snapshot: Snapshot, state: PiedPiperState) -> Float[Array, " a"]:
    """How far each agent still has to walk [m]."""

    def to(pos: Array, column: Array, field: Array | None) -> Array:
        return geodesic_distance(snapshot.bank, snapshot.house, column, pos, field)

    own, stray = _columns(state)
    pos = snapshot.pose.pos
    piper = to(pos[PIPER], own[PIPER], snapshot.tasks.field)
    return jax.vmap(lambda at, column: to(at, column, None))(pos, stray).at[PIPER].set(piper)


def _aims(snapshot: Snapshot, state: PiedPiperState) -> Float[Array, "a 2"]:
    """Where each agent walks straight on its way [m]."""
    own, stray = _columns(state)
    fields_ = snapshot.tasks.field, snapshot.bank.navigation.field

    def one(agent: Array) -> Array:
        def far(_: Array, cell: Array) -> Array:
            piper, other = (stored_distance(f, cell, c[agent]) for f, c in zip(fields_, (own, stray), strict=True))
            return jnp.where(agent == PIPER, piper, other)

        return descend(snapshot, agent, far)[0]

    return jax.vmap(one)(jnp.arange(snapshot.config.num_agents))
