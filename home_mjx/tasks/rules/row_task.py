"""Task whose episodes are rows of a task bank."""

from dataclasses import dataclass

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.audio_jax.base.endpoints import Sounds
from home_mjx.bank.bank import HouseBank
from home_mjx.core.checks import check_flag, check_number
from home_mjx.core.pytree import Pytree
from home_mjx.errors import ConfigError
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.base.specs import ArraySpec, Specs
from home_mjx.tasks.base.task import Task, path_scores
from home_mjx.tasks.communication.talk import NONE, Talk, as_observed, is_told, of_others, replies, talk_of
from home_mjx.tasks.rules.build import Generator, build_task_bank
from home_mjx.tasks.rules.features import Looked, emitters, look
from home_mjx.tasks.rules.machine import advance, conditions
from home_mjx.tasks.rules.meaning import Means, means
from home_mjx.tasks.rules.program import Program
from home_mjx.tasks.rules.task_bank import TaskBank, program_of
from home_mjx.tasks.rules.words import ANY, FAILURE, NUM_TOKENS, SUCCESS, Feature, Word
from home_mjx.tasks.sounds.emit import emitted
from home_mjx.tasks.sounds.row import Emission, emission_of, is_audible

FARTHEST = 1000.0  # [m] upper bound of distances; no house is larger
LEAP = 2.0  # [m] maximum progress per step: distances jump when a target changes storey or appears
COSTS = ("step_cost", "contact_cost", "question_cost", "failure_cost")
HEARD = {
    "reply": "token of the oracle's reply to the last word",
    "heard_words": "token of the last word of another agent, unless words are sounds",
}


class RowState(Pytree):
    """Task state of one episode; A agents."""

    program: Program
    means: Means
    emission: Emission
    task: Int[Array, ""]  # index into `TaskBank.names`
    tokens: Int[Array, " n"]
    length: Float[Array, ""]  # [m], of the shortest path from start to goal
    stage: Int[Array, ""]
    since: Int[Array, ""]  # step in which the stage began
    gained: Float[Array, ""]  # reward of the last transition
    distance: Float[Array, "a d"]  # [m], to the nearest target of each descriptor
    place: Float[Array, "a 3"]  # [m], position of each agent
    walked: Float[Array, " a"]  # [m], length of each agent's path
    collisions: Int[Array, " a"]  # steps in which an agent touched anything but the floor
    talk: Talk
    reply: Int[Array, " a"]  # token of the oracle's reply in the last step; -1 if none
    asked: Int[Array, ""]  # number of questions that the oracle has answered
    spoken: Int[Array, ""]  # number of words that agents have said
    mistakes: Int[Array, ""]  # number of wrong stops, answers and the like; at most 1 where they end the episode
    looked: Looked | None  # features that decided the last transition, if `RowTask.keep_looks`


@dataclass(frozen=True)
class RowTask(Task):
    """Base of tasks whose episodes are rows of a `TaskBank`; the compiled step is the same for any rows.

    Attributes:
        num_tasks: Maximum number of rows per house.
        task_seed: Seed of the rows' random draws.
        min_length: Minimum shortest-path length from start to goal [m].
        max_length: Maximum shortest-path length from start to goal [m].
        progress_reward: Reward per metre of progress towards the stage's guide.
        step_cost: Cost of every step.
        contact_cost: Cost of a step in which the agent touches anything but the floor.
        question_cost: Cost of each question that an oracle answers.
        failure_cost: Cost of a mistake, such as a wrong `stop` or answer; running out of time is not a mistake. At 0,
            agents that still navigate poorly learn to stop at once.
        mistakes_end: A mistake ends the episode. False, for training: it costs, and the episode continues.
        keep_looks: States keep the feature values of conditions, so that experts need not compute them again; required
            by `with_expert`.
    """

    num_tasks: int = 64
    task_seed: int = 0
    min_length: float = 1.0
    max_length: float = FARTHEST
    progress_reward: float = 1.0
    step_cost: float = 0.01
    contact_cost: float = 0.01
    question_cost: float = 0.05
    failure_cost: float = 0.0
    mistakes_end: bool = True
    keep_looks: bool = False

    def __post_init__(self) -> None:
        check_number("num_tasks", self.num_tasks, 1, whole=True)
        check_number("task_seed", self.task_seed, 0, whole=True)
        check_flag("keep_looks", self.keep_looks)
        check_flag("mistakes_end", self.mistakes_end)
        for name in ("min_length", "max_length", "progress_reward", *COSTS):
            check_number(name, getattr(self, name), 0)

    @property
    def stops_for_good(self) -> bool:
        """True if mistakes end episodes."""
        return self.mistakes_end

    @property
    def generators(self) -> tuple[Generator, ...]:
        """Generators of the rows."""
        raise NotImplementedError

    @property
    def speech(self) -> tuple[str, ...]:
        """Speech actions of all generators."""
        return tuple(dict.fromkeys(word for task in self._others for word in getattr(task, "speech", ())))

    @property
    def hears(self) -> tuple[str, ...]:
        """Speech observations of all generators, from `HEARD`."""
        return tuple(dict.fromkeys(name for task in self._others for name in getattr(task, "hears", ())))

    @property
    def least_agents(self) -> int:
        """Minimum number of agents, the largest of all generators."""
        return max((getattr(task, "least_agents", 1) for task in self._others), default=1)

    @property
    def _others(self) -> tuple[Generator, ...]:
        return tuple(task for task in self.generators if task is not self)

    @property
    def observation_spec(self) -> Specs:
        """Specs of `goal`, `goal_words` and `instruction`; of `reply` and `heard_words` in tasks that use them."""
        polar = "distance [m], cosine and sine of the bearing of a goal point, left positive; 0 for other goals"
        return {
            "goal": ArraySpec((3,), "float32", (0.0, -1.0, -1.0), (FARTHEST, 1.0, 1.0), polar),
            "goal_words": ArraySpec((len(Word),), "int32", -1, 32767, "first descriptor, columns `Word`; -1 any"),
            "instruction": ArraySpec((NUM_TOKENS,), "int32", 0, 32767, "tokens; 0 ends"),
            **{name: ArraySpec((1,), "int32", 0, 32767, f"{HEARD[name]}; 0 none") for name in self.hears},
        }

    def task_bank(self, bank: HouseBank) -> TaskBank:
        """Build a task bank for these houses."""
        limits = self.min_length, self.max_length
        return build_task_bank(bank, self.generators, self.num_tasks, self.task_seed, *limits)

    def init(self, snapshot: Snapshot, key: Array, columns: dict[str, Array] | None) -> RowState:
        """Return the state at the first stage of the row's program."""
        if columns is None or not isinstance(snapshot.tasks, TaskBank):
            hint = "Write EnvParams(bank, tasks=task.task_bank(bank)), or core.bind(bank)."
            raise ConfigError(f"{type(self).__name__} needs a task bank", hint=hint)
        program = program_of(columns)
        agents, zero = snapshot.pose.yaw.shape[0], jnp.zeros((), jnp.int32)
        meant = means(snapshot.bank, snapshot.house, program.descriptor)
        looked = look(snapshot, program, meant, snapshot.tasks.field, zero)
        return RowState(
            program=program,
            means=meant,
            emission=emission_of(columns),
            task=columns["task"].astype(jnp.int32),
            tokens=columns["tokens"].astype(jnp.int32),
            length=columns["length"],
            stage=zero,
            since=zero,
            gained=jnp.zeros((), jnp.float32),
            distance=looked.values[Feature.DISTANCE, :, :, 0],
            place=snapshot.pose.pos,
            walked=jnp.zeros(agents, jnp.float32),
            collisions=jnp.zeros(agents, jnp.int32),
            talk=talk_of(columns),
            reply=jnp.full(agents, NONE, jnp.int32),
            asked=zero,
            spoken=zero,
            mistakes=zero,
            looked=looked if self.keep_looks else None,
        )

    def update(self, snapshot: Snapshot, state: RowState) -> RowState:
        """Compute the feature values and take the first transition whose conditions hold."""
        state = state.replace(program=_followed(snapshot, state))
        time = snapshot.step - state.since
        looked = look(snapshot, state.program, state.means, snapshot.tasks.field, time)
        stage, gained, taken = advance(state.program, state.stage, conditions(state.program, looked.values))
        mistaken = (stage == FAILURE) | (self.have_stopped(snapshot) & (stage != SUCCESS))
        if not self.mistakes_end:
            forgiven = stage == FAILURE
            stage, taken = jnp.where(forgiven, state.stage, stage), taken & ~forgiven
        moved = jnp.linalg.norm(snapshot.pose.pos - state.place, axis=-1)
        reply = replies(state.talk, snapshot.said)
        return state.replace(
            stage=stage.astype(jnp.int32),
            since=jnp.where(taken, snapshot.step, state.since),
            gained=gained,
            distance=looked.values[Feature.DISTANCE, :, :, 0],
            place=snapshot.pose.pos,
            walked=state.walked + moved,
            collisions=state.collisions + snapshot.contact.astype(jnp.int32),
            reply=reply,
            asked=state.asked + jnp.sum(reply >= 0, dtype=jnp.int32),
            spoken=state.spoken + jnp.sum(snapshot.said >= 0, dtype=jnp.int32),
            mistakes=state.mistakes + mistaken,
            looked=looked if self.keep_looks else None,
        )

    def sounds(self, snapshot: Snapshot, state: RowState) -> Sounds:
        """Return the current sounds of the row; if it has none, the house's source."""
        point, body = emitters(snapshot, state.program, state.means)
        return emitted(snapshot, state.emission, point, body, snapshot.tasks.field, state.program.field)

    def observe(self, snapshot: Snapshot, state: RowState) -> dict[str, Array]:
        """Compute the observations of `observation_spec`."""
        pose, place = snapshot.pose, state.program.place[0]
        known = jnp.all(jnp.isfinite(place))
        offset = jnp.where(known, place[:2] - pose.pos[:, :2], 0.0)
        bearing = jnp.arctan2(offset[:, 1], offset[:, 0]) - pose.yaw
        goal = jnp.stack([jnp.linalg.norm(offset, axis=-1), jnp.cos(bearing), jnp.sin(bearing)], axis=-1)
        told = is_told(state.talk, pose.yaw.shape[0])[:, None]
        words = jnp.where(is_audible(state.emission), NONE, of_others(snapshot.said))
        heard = {"reply": state.reply, "heard_words": words}
        return {
            "goal": jnp.where(known & told, goal, 0.0),
            "goal_words": jnp.where(told, state.program.descriptor[0].astype(jnp.int32), ANY),
            "instruction": jnp.where(told, state.tokens, 0),
            **{name: as_observed(heard[name]) for name in self.hears},
        }

    def reward(self, snapshot: Snapshot, before: RowState, state: RowState) -> Float[Array, " a"]:
        """Compute the transition's reward plus that of progress towards the stage's guide, minus costs."""
        guide = state.program.guide[jnp.maximum(before.stage, 0)]
        progress = (before.distance - state.distance)[:, jnp.maximum(guide, 0)]
        progress = jnp.where(guide < 0, 0.0, jnp.clip(progress, -LEAP, LEAP))
        costs = jnp.float32(self.step_cost) + jnp.float32(self.contact_cost) * snapshot.contact.astype(jnp.float32)
        costs = costs + jnp.float32(self.question_cost) * (state.reply >= 0)
        costs = costs + jnp.float32(self.failure_cost) * (state.mistakes - before.mistakes)
        return jnp.float32(self.progress_reward) * progress + state.gained - costs

    def terminated(self, snapshot: Snapshot, state: RowState) -> Bool[Array, ""]:
        """Return whether a final stage is reached, or all acting agents stopped and mistakes end episodes."""
        return (state.stage < 0) | (self.have_stopped(snapshot) & self.mistakes_end)

    def metrics(self, snapshot: Snapshot, state: RowState) -> dict[str, Float[Array, ""]]:
        """Return Habitat's metrics (success, SPL, soft SPL, distance to the goal [m], collisions) and the stage.

        See `path_scores`; path lengths are those of the first agent. Tasks with speech add `answered`, whether the
        row's question was answered, rightly or wrongly, and `questions`, the number of questions asked.
        """
        success = (state.stage == SUCCESS).astype(jnp.float32)
        goal = jnp.maximum(state.program.guide[0], 0)
        left = jnp.min(state.distance[:, goal])
        return {
            "success": success,
            **path_scores(success, state.length, state.walked[0], left),
            "distance": left,
            "collisions": jnp.mean(state.collisions.astype(jnp.float32)),
            "stage": state.stage.astype(jnp.float32),
            **self._spoken(state),
        }

    def _spoken(self, state: RowState) -> dict[str, Float[Array, ""]]:
        if not self.speech:
            return {}
        answered = (state.spoken > 0) & (state.talk.answer >= 0)
        return {"answered": answered.astype(jnp.float32), "questions": state.asked.astype(jnp.float32)}


def _followed(snapshot: Snapshot, state: RowState) -> Program:
    """Return the program with the current positions of moving sound sources."""
    count = min(snapshot.sounds.clip.shape[0], state.emission.emitter.shape[0])
    speed, emitter = state.emission.speed[:count], state.emission.emitter[:count].astype(jnp.int32)
    place = snapshot.sounds.pos[:count].at[:, 2].add(-jnp.float32(snapshot.config.source_height))
    beyond = state.program.place.shape[0]
    to = jnp.where((speed > 0) & (emitter >= 0), emitter, beyond)
    return state.program.replace(place=state.program.place.at[to].set(place, mode="drop"))
