"""Task whose episodes are rows of a task bank."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from home_mjx.audio_jax.base.endpoints import SoundSources
from home_mjx.bank.bank import HouseBank
from home_mjx.core.checks import check_flag, check_number
from home_mjx.core.pytree import Pytree
from home_mjx.errors import ConfigError
from home_mjx.tasks.base.goal_observation import GOAL_SPEC, MAX_GOAL_DISTANCE, observe_goal
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.base.specs import ArraySpec, Specs
from home_mjx.tasks.base.task import Task, path_scores
from home_mjx.tasks.rules.build_bank import TaskGenerator, TaskRow, build_task_bank
from home_mjx.tasks.rules.containment import start_compartments, start_poses
from home_mjx.tasks.rules.declaration import extract
from home_mjx.tasks.rules.enums import ANY, FAILURE, NO_WORD, NUM_TOKENS, SUCCESS, Attribute, Feature
from home_mjx.tasks.rules.features import FeatureValues, compute_features, sound_positions, switch_targets
from home_mjx.tasks.rules.house_view import HouseView
from home_mjx.tasks.rules.program import TaskProgram, evaluate_conditions, take_transition
from home_mjx.tasks.rules.resolve import ResolvedTargets, resolve_targets
from home_mjx.tasks.rules.speech import SpeechColumns, is_instructed, observe_words, oracle_replies, words_of_others
from home_mjx.tasks.rules.task_bank import TaskBank
from home_mjx.tasks.sounds.sound_events import SoundEvents, has_voices
from home_mjx.tasks.sounds.sources import row_sources

MAX_STEP_PROGRESS = 2.0  # [m] maximum progress per step: distances jump when a target changes storey or appears
COST_OPTIONS = ("step_cost", "contact_cost", "question_cost", "failure_cost")
SPEECH_OBSERVATIONS = {
    "reply": "token of the oracle's reply to the last word",
    "heard_words": "token of the last word of another agent, unless words are sounds",
}


class RowState(Pytree):
    """Task state of one episode; A agents."""

    program: TaskProgram
    targets: ResolvedTargets
    sound_events: SoundEvents
    task: Int[Array, ""]  # index into `TaskBank.names`
    tokens: Int[Array, " n"]
    length: Float[Array, ""]  # [m], of the shortest path from start to goal
    stage: Int[Array, ""]
    stage_start: Int[Array, ""]  # step in which the stage began
    transition_reward: Float[Array, ""]  # reward of the last transition
    distance: Float[Array, "a d"]  # [m], to the nearest target of each descriptor
    goal: Int[Array, ""]  # descriptor of the present goal, see `present_goal`; of the last one after the final stage
    later_legs: Float[Array, ""]  # [m], of the shortest path beyond the present goal; 0 for the last one
    position: Float[Array, "a 3"]  # [m], position of each agent
    path_length: Float[Array, " a"]  # [m], length of each agent's path; 0 if the task is fulfilled at the start
    is_fulfilled_at_start: Bool[Array, ""]  # success holds at the start, so the first step's way does not count
    collisions: Int[Array, " a"]  # steps with `Snapshot.has_collided`
    speech: SpeechColumns
    reply: Int[Array, " a"]  # token of the oracle's reply in the last step; -1 if none
    num_questions: Int[Array, ""]  # number of questions that the oracle has answered
    num_words: Int[Array, ""]  # number of words that agents have said
    num_mistakes: Int[Array, ""]  # number of wrong stops, answers and the like; at most 1 where they end the episode
    features: FeatureValues | None  # features that decided the last transition, if `RowTask.store_features`


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
        failure_cost: Cost of a mistake, such as a wrong `stop` or answer; running out of time is not a mistake. At
            0, agents that still navigate poorly learn to stop at once.
        terminate_on_failure: A mistake ends the episode. False, for training: it costs, and the episode continues.
        store_features: States keep the feature values of conditions, so that experts need not compute them again;
            required by `add_expert`.
    """

    num_tasks: int = 64
    task_seed: int = 0
    min_length: float = 1.0
    max_length: float = MAX_GOAL_DISTANCE
    progress_reward: float = 1.0
    step_cost: float = 0.01
    contact_cost: float = 0.01
    question_cost: float = 0.05
    failure_cost: float = 0.0
    terminate_on_failure: bool = True
    store_features: bool = False

    def __post_init__(self) -> None:
        check_number("num_tasks", self.num_tasks, 1, integer=True)
        check_number("task_seed", self.task_seed, 0, integer=True)
        check_flag("store_features", self.store_features)
        check_flag("terminate_on_failure", self.terminate_on_failure)
        for name in ("min_length", "max_length", "progress_reward", *COST_OPTIONS):
            check_number(name, getattr(self, name), 0)

    @property
    def stop_is_final(self) -> bool:
        """True if agents stay idle after `stop`, because mistakes end episodes."""
        return self.terminate_on_failure

    @property
    def generators(self) -> tuple[TaskGenerator, ...]:
        """Generators of the rows; a subclass must implement it."""
        raise NotImplementedError

    @property
    def speech(self) -> tuple[str, ...]:
        """Speech actions of all generators, each once; a task that is its own generator overrides this."""
        return tuple(dict.fromkeys(word for task in self._other_generators for word in getattr(task, "speech", ())))

    @property
    def speech_observations(self) -> tuple[str, ...]:
        """Names of the speech observations of all generators, from `SPEECH_OBSERVATIONS`, each once."""
        return tuple(
            dict.fromkeys(name for task in self._other_generators for name in getattr(task, "speech_observations", ()))
        )

    @property
    def min_agents(self) -> int:
        """Minimum number of agents, the largest of all generators."""
        return max((getattr(task, "min_agents", 1) for task in self._other_generators), default=1)

    @property
    def _other_generators(self) -> tuple[TaskGenerator, ...]:
        """Generators without the task itself, which may be one."""
        return tuple(task for task in self.generators if task is not self)

    @property
    def observation_spec(self) -> Specs:
        """Specs of `goal`, `goal_words` and `instruction`; of `reply` and `heard_words` in tasks that use them."""
        goal = replace(GOAL_SPEC, text=f"{GOAL_SPEC.text}; 0 for goals that are no points")
        return {
            "goal": goal,
            "goal_words": ArraySpec(
                (len(Attribute),), "int32", -1, 32767, "first descriptor, columns `Attribute`; -1 any"
            ),
            "instruction": ArraySpec((NUM_TOKENS,), "int32", 0, 32767, "tokens; 0 ends"),
            **{
                name: ArraySpec((1,), "int32", 0, 32767, f"{SPEECH_OBSERVATIONS[name]}; 0 none")
                for name in self.speech_observations
            },
        }

    def task_bank(self, bank: HouseBank) -> TaskBank:
        """Build a task bank for these houses; raises as `build_task_bank`."""
        limits = self.min_length, self.max_length
        return build_task_bank(bank, self.generators, self.num_tasks, self.task_seed, *limits)

    def init(self, snapshot: Snapshot, key: Array, columns: dict[str, Array] | None) -> RowState:
        """Return the state at the first stage of the row's program; `ConfigError` without a task bank.

        No transition is taken yet, but `is_fulfilled_at_start` is True if success holds already. `later_legs` is the
        row's length less the distance to the first goal, or 0 if no other stage has another guide.
        """
        if columns is None or not isinstance(snapshot.tasks, TaskBank):
            hint = "Write EnvParams(bank, tasks=task.task_bank(bank)), or core.bind(bank)."
            raise ConfigError(f"{type(self).__name__} needs a task bank", hint=hint)
        program = extract(TaskProgram, columns)
        agents, zero = snapshot.pose.yaw.shape[0], jnp.zeros((), jnp.int32)
        meant = resolve_targets(snapshot.bank, snapshot.house, program.descriptor)
        looked = compute_features(snapshot, program, meant, snapshot.tasks.field, zero)
        first_stage = take_transition(program, zero, evaluate_conditions(program, looked.values))[0]
        distance = looked.values[Feature.DISTANCE, :, :, 0]
        goal = present_goal(program, zero, zero)
        has_more = jnp.any((program.guide >= 0) & (program.guide != goal))
        later = jnp.maximum(columns["length"] - jnp.min(distance[:, goal]), 0.0)
        return RowState(
            program=program,
            targets=meant,
            sound_events=extract(SoundEvents, columns),
            task=columns["task"].astype(jnp.int32),
            tokens=columns["tokens"].astype(jnp.int32),
            length=columns["length"],
            stage=zero,
            stage_start=zero,
            transition_reward=jnp.zeros((), jnp.float32),
            distance=distance,
            goal=goal,
            later_legs=jnp.where(has_more & jnp.isfinite(later), later, 0.0),
            position=snapshot.pose.pos,
            path_length=jnp.zeros(agents, jnp.float32),
            is_fulfilled_at_start=first_stage == SUCCESS,
            collisions=jnp.zeros(agents, jnp.int32),
            speech=jax.tree.map(lambda column: column.astype(jnp.int32), extract(SpeechColumns, columns)),
            reply=jnp.full(agents, NO_WORD, jnp.int32),
            num_questions=zero,
            num_words=zero,
            num_mistakes=zero,
            features=looked if self.store_features else None,
        )

    def start_switches(self, snapshot: Snapshot, columns: dict[str, Array] | None) -> Bool[Array, " s"] | None:
        """Return the sampled states, but for targets of conditions SWITCHED_ON: these start in the opposite state."""
        if snapshot.switch_on is None or columns is None:
            return snapshot.switch_on
        program = extract(TaskProgram, columns)
        meant = switch_targets(snapshot, resolve_targets(snapshot.bank, snapshot.house, program.descriptor))
        asked = (program.feature == Feature.SWITCHED_ON)[:, None] & meant[jnp.maximum(program.first, 0)]
        off, on = (jnp.any(asked & which[:, None], axis=0) for which in (program.minimum > 0, program.minimum <= 0))
        return (snapshot.switch_on & ~off) | on

    def start_bodies(
        self, snapshot: Snapshot, columns: dict[str, Array] | None
    ) -> tuple[Bool[Array, " k"], Float[Array, "k 3"], Float[Array, "k 4"]] | None:
        """Return the bodies that begin in a compartment, and those that leave it for them; see `start_poses`."""
        if columns is None or not snapshot.bank.spec.num_bodies:
            return None
        program = extract(TaskProgram, columns)
        meant = resolve_targets(snapshot.bank, snapshot.house, program.descriptor)
        return start_poses(snapshot, start_compartments(snapshot, program, meant))

    def update(self, snapshot: Snapshot, state: RowState) -> RowState:
        """Take the first transition whose conditions hold; update features, path lengths, collisions and speech.

        Without `terminate_on_failure`, a failure counts as a mistake and the stage stays.
        """
        state = state.replace(program=_track_moving_sources(snapshot, state))
        time = snapshot.step - state.stage_start
        looked = compute_features(snapshot, state.program, state.targets, snapshot.tasks.field, time)
        stage, gained, taken = take_transition(
            state.program, state.stage, evaluate_conditions(state.program, looked.values)
        )
        mistaken = (stage == FAILURE) | (self.all_stopped(snapshot) & (stage != SUCCESS))
        if not self.terminate_on_failure:
            forgiven = stage == FAILURE
            stage, taken = jnp.where(forgiven, state.stage, stage), taken & ~forgiven
        moved = jnp.linalg.norm(snapshot.pose.pos - state.position, axis=-1)
        is_done_at_once = (snapshot.step <= 1) & state.is_fulfilled_at_start & (stage == SUCCESS)
        moved = jnp.where(is_done_at_once, 0.0, moved)
        reply = oracle_replies(state.speech, snapshot.spoken_token)
        distance = looked.values[Feature.DISTANCE, :, :, 0]
        goal = present_goal(state.program, stage, state.goal)
        return state.replace(
            goal=goal,
            later_legs=_pass_goal(state, stage, goal, distance),
            stage=stage.astype(jnp.int32),
            stage_start=jnp.where(taken, snapshot.step, state.stage_start),
            transition_reward=gained,
            distance=distance,
            position=snapshot.pose.pos,
            path_length=state.path_length + moved,
            collisions=state.collisions + snapshot.has_collided.astype(jnp.int32),
            reply=reply,
            num_questions=state.num_questions + jnp.sum(reply >= 0, dtype=jnp.int32),
            num_words=state.num_words + jnp.sum(snapshot.spoken_token >= 0, dtype=jnp.int32),
            num_mistakes=state.num_mistakes + mistaken,
            features=looked if self.store_features else None,
        )

    def sounds(self, snapshot: Snapshot, state: RowState) -> SoundSources:
        """Return the current sounds of the row; if it has none, the house's source."""
        point, body = sound_positions(snapshot, state.program, state.targets)
        return row_sources(snapshot, state.sound_events, point, body, snapshot.tasks.field, state.program.field)

    def observe(self, snapshot: Snapshot, state: RowState) -> dict[str, Array]:
        """Return the observations of `observation_spec`; uninstructed agents have no goal and no instruction.

        `goal` leads to the point of the first descriptor, and is 0 if that is not a point. `goal_words` are its values.
        """
        pose, place = snapshot.pose, state.program.place[0]
        known = jnp.all(jnp.isfinite(place))
        goal = observe_goal(snapshot, jnp.where(known, place, 0.0))
        told = is_instructed(state.speech, pose.yaw.shape[0])[:, None]
        words = jnp.where(has_voices(state.sound_events), NO_WORD, words_of_others(snapshot.spoken_token))
        heard = {"reply": state.reply, "heard_words": words}
        return {
            "goal": jnp.where(known & told, goal, 0.0),
            "goal_words": jnp.where(told, state.program.descriptor[0].astype(jnp.int32), ANY),
            "instruction": jnp.where(told, state.tokens, 0),
            **{name: observe_words(heard[name]) for name in self.speech_observations},
        }

    def reward(self, snapshot: Snapshot, before: RowState, state: RowState) -> Float[Array, " a"]:
        """Return per agent the transition's reward and progress to the guide, minus costs of steps, contacts and so on.

        The guide is that of the stage before the step; a step's progress is at most `MAX_STEP_PROGRESS` [m] either way.
        """
        terms = self.reward_terms(snapshot, before, state)
        costs = terms["steps"] + terms["contacts"] + terms["questions"] + terms["mistakes"]
        return terms["progress"] + terms["transitions"] + costs

    def reward_terms(self, snapshot: Snapshot, before: RowState, state: RowState) -> dict[str, Float[Array, " a"]]:
        """Return the terms of `reward`; costs are negative."""
        guide = state.program.guide[jnp.maximum(before.stage, 0)]
        progress = (before.distance - state.distance)[:, jnp.maximum(guide, 0)]
        progress = jnp.where(guide < 0, 0.0, jnp.clip(progress, -MAX_STEP_PROGRESS, MAX_STEP_PROGRESS))
        terms = {
            "progress": jnp.float32(self.progress_reward) * progress,
            "transitions": state.transition_reward,
            "steps": -jnp.float32(self.step_cost),
            "contacts": -jnp.float32(self.contact_cost) * snapshot.in_contact.astype(jnp.float32),
            "questions": -jnp.float32(self.question_cost) * (state.reply >= 0),
            "mistakes": -jnp.float32(self.failure_cost) * (state.num_mistakes - before.num_mistakes),
        }
        return {name: jnp.broadcast_to(term, progress.shape) for name, term in terms.items()}

    def terminated(self, snapshot: Snapshot, state: RowState) -> Bool[Array, ""]:
        """Return whether a final stage is reached, or all acting agents stopped and mistakes end episodes."""
        return (state.stage < 0) | (self.all_stopped(snapshot) & self.terminate_on_failure)

    def metrics(self, snapshot: Snapshot, state: RowState) -> dict[str, Float[Array, ""]]:
        """Return Habitat's metrics (success, SPL, soft SPL, distance to the goal [m], collisions) and the stage.

        The distance is that of the agent nearest to the present goal, plus the legs to later goals. See `path_scores`;
        path lengths are those of the first agent. Tasks with speech add `answered`, whether the row's question was
        answered, rightly or wrongly, and `questions`, the number of questions asked.
        """
        success = (state.stage == SUCCESS).astype(jnp.float32)
        left = jnp.min(state.distance[:, state.goal]) + state.later_legs
        return {
            "success": success,
            **path_scores(success, state.length, state.path_length[0], left),
            "distance": left,
            "collisions": jnp.mean(state.collisions.astype(jnp.float32)),
            "stage": state.stage.astype(jnp.float32),
            **self._speech_metrics(state),
        }

    def _speech_metrics(self, state: RowState) -> dict[str, Float[Array, ""]]:
        """Return `answered` and `questions`, see `metrics`; empty for tasks without speech."""
        if not self.speech:
            return {}
        answered = (state.num_words > 0) & (state.speech.answer >= 0)
        return {"answered": answered.astype(jnp.float32), "questions": state.num_questions.astype(jnp.float32)}


def present_goal(program: TaskProgram, stage: Int[Array, ""], last: Int[Array, ""]) -> Int[Array, ""]:
    """Return the descriptor that a stage guides to; `last` for final (negative) stages and stages without guide."""
    guide = program.guide[jnp.maximum(stage, 0)].astype(jnp.int32)
    return jnp.where((stage >= 0) & (guide >= 0), guide, last)


def _pass_goal(
    state: RowState, stage: Int[Array, ""], goal: Int[Array, ""], distance: Float[Array, "a d"]
) -> Float[Array, ""]:
    """Return `later_legs` [m], the path length beyond the goal of the new stage; unchanged if the goal is the same.

    A later stage takes off the distance to its goal, an earlier one adds that to the old goal again. Distances are
    those of the nearest agent; an infinite one changes nothing. The result is at least 0, and 0 on success.
    """
    leg, old_leg = jnp.min(distance[:, goal]), jnp.min(distance[:, state.goal])
    change = jnp.where(stage > state.stage, -leg, old_leg)
    is_passed = (goal != state.goal) & jnp.isfinite(change)
    later = jnp.maximum(jnp.where(is_passed, state.later_legs + change, state.later_legs), 0.0)
    return jnp.where(stage == SUCCESS, 0.0, later)


def _track_moving_sources(snapshot: Snapshot, state: RowState) -> TaskProgram:
    """Return the program with `place` of descriptors that are moving sources set to the present floor points below."""
    count = min(snapshot.sounds.clip.shape[0], state.sound_events.emitter.shape[0])
    speed, emitter = state.sound_events.speed[:count], state.sound_events.emitter[:count].astype(jnp.int32)
    place = snapshot.sounds.pos[:count].at[:, 2].add(-jnp.float32(snapshot.config.source_height))
    beyond = state.program.place.shape[0]
    to = jnp.where((speed > 0) & (emitter >= 0), emitter, beyond)
    return state.program.replace(place=state.program.place.at[to].set(place, mode="drop"))


@dataclass(frozen=True)
class GeneratorTask(RowTask):
    """Base of row tasks that generate their rows themselves."""

    @property
    def name(self) -> str:
        """Name of the task: that of its class."""
        return type(self).__name__

    @property
    def generators(self) -> tuple[TaskGenerator, ...]:
        """Generators of the rows: the task itself."""
        return (self,)

    def rows(self, view: HouseView, random: np.random.Generator) -> Iterator[TaskRow]:
        """Yield rows of tasks of one house, possibly endlessly; a subclass must implement it."""
        raise NotImplementedError
