"""Observers of episodes and runs: films, terminals, metrics files, progress bars and viewers (host only).

`home-mjx play`, `train` and `demo` emit the events of one protocol, `Observer`, and know nothing of who observes. A
distribution adds an observer with an entry point of the group `home_mjx.observers`, whose name is the observer's and
whose object makes it.
"""

from collections.abc import Callable, Iterable, Mapping
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from types import TracebackType
from typing import Any, NamedTuple, Protocol, runtime_checkable

import numpy as np

from home_mjx.core.paths import installed
from home_mjx.errors import ConfigError, UnknownNameError, did_you_mean
from home_mjx.tasks.base.state import State
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv

GROUP = "home_mjx.observers"


class RunStart(NamedTuple):
    """Start of a run, after everything is compiled.

    Attributes:
        name: Name of the acting agent, or of the algorithm.
        env: The environment.
        unit: Unit of progress, in the plural: `episodes` or `steps`.
        total: Units of the whole run.
        done: Units of earlier parts of a resumed run.
    """

    name: str
    env: Env[HouseholdEnv] | None
    unit: str
    total: int
    done: int = 0


class EpisodeStart(NamedTuple):
    """Start of an episode.

    Attributes:
        number: Number of the episode, from 1.
        row: Row of the environment's episodes or tasks; None: sampled.
        house: Id of the house.
        task: Name of the task.
        instruction: Instruction; a description of the goal for tasks without one.
        path_length: Length of the shortest path [m]; NaN if unknown.
        key: Raw key of the reset, 2 words; None if unknown.
    """

    number: int
    row: int | None
    house: str
    task: str
    instruction: str
    path_length: float
    key: Any = None


class EpisodeStep(NamedTuple):
    """Step of an episode.

    Attributes:
        index: Number of the step; 0 is the reset.
        state: State after the step, on the device; an observer that reads nothing of it costs nothing.
        action: Action of all agents; None for the reset.
        episode_return: Return of the first agent so far.
    """

    index: int
    state: State
    action: Any
    episode_return: float


@dataclass(frozen=True)
class EpisodeResult:
    """Result of an episode.

    Attributes:
        number: Number of the episode, from 1.
        task: Name of the task.
        instruction: Instruction of the episode.
        house: Id of the house.
        success: The task's success metric.
        spl: Success weighted by path length (arXiv:1807.06757); NaN if the shortest path is unknown.
        steps: Number of steps.
        episode_return: Return of the first agent.
        metrics: All metrics of the task at the end.
    """

    number: int
    task: str
    instruction: str
    house: str
    success: float
    spl: float
    steps: int
    episode_return: float
    metrics: dict[str, float] = field(default_factory=dict)

    def format_line(self) -> str:
        """Format the result as one line of text; long names are not cut, an unknown SPL is `-`.

        It is `success` if that is above 0, else `failure`.

        Example:
            >>> EpisodeResult(1, "RoomNav", "RoomNav: the kitchen", "a0", 1.0, 0.9312, 24, 3.1).format_line()
            '  1  RoomNav               success  SPL 0.93    24 steps  RoomNav: the kitchen'
        """
        how = "success" if self.success > 0 else "failure"
        spl = "   -" if np.isnan(self.spl) else f"{self.spl:.2f}"
        return f"{self.number:3d}  {self.task:<20}  {how}  SPL {spl}  {self.steps:4d} steps  {self.instruction}"


@runtime_checkable
class Observer(Protocol):
    """Interface of observers; a subclass inherits empty methods and overrides those that it needs.

    All methods are called on the host, between two steps, in the order of the observers. An exception ends the run;
    `close` is called in either case. Observers must not change the states that they are given.

    Example:
        >>> class EpisodeLengths(Observer):
        ...     def on_episode_end(self, result):
        ...         print(result.steps)
        >>> register_observer("lengths", EpisodeLengths)  # doctest: +SKIP
        >>> run_play(PlayOptions(find_spec("PointNav-v0")), observers=["lengths"])  # doctest: +SKIP
    """

    def on_run_start(self, start: RunStart) -> None:
        """Handle the start of a run; called once, before all other events."""

    def on_phase(self, name: str, note: str = "") -> None:
        """Handle the start of a part of a run, such as `drawing`; `note` explains a long wait."""

    def on_update(self, count: int) -> None:
        """Handle progress: `count` more units of `RunStart.unit` are done."""

    def on_states(self, states: State) -> None:
        """Handle the states of all environments, on the device, after an update of training."""

    def on_episode_start(self, start: EpisodeStart) -> None:
        """Handle the start of an episode; its first `on_episode_step` follows."""

    def on_episode_step(self, step: EpisodeStep) -> None:
        """Handle the reset or a step, before the next action is chosen."""

    def on_episode_end(self, result: EpisodeResult) -> None:
        """Handle the end of an episode."""

    def on_log(self, line: Mapping[str, float]) -> None:
        """Handle a line of training metrics, averaged over updates: `steps`, `seconds`, `success`, `loss/value`."""

    def on_checkpoint(self, path: Path, steps: int) -> None:
        """Handle a checkpoint, which is on disk, after `steps` environment steps of training."""

    def write(self, folder: Path) -> None:
        """Write files into a folder at the end of a run without errors; they appear together, or none does."""

    def close(self) -> None:
        """Release resources; called exactly once, also after errors."""


class ObserverGroup(Observer):
    """Several observers as one: a context that closes all of them, in reverse order.

    Args:
        observers: The observers, in the order in which they are called.

    Raises:
        Exception: On exit, the first error of a `close`, unless the block has raised one itself.
    """

    def __init__(self, observers: Iterable[Observer]) -> None:
        self.observers = tuple(observers)

    def __enter__(self) -> "ObserverGroup":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            self.close()
        except Exception:
            if error is None:
                raise

    def on_run_start(self, start: RunStart) -> None:
        """Call `on_run_start` of all observers, in order; an exception of one passes, and later ones are not called."""
        for observer in self.observers:
            observer.on_run_start(start)

    def on_phase(self, name: str, note: str = "") -> None:
        """Call `on_phase` of all observers, in order; an exception of one ends the calls."""
        for observer in self.observers:
            observer.on_phase(name, note)

    def on_update(self, count: int) -> None:
        """Call `on_update` of all observers, in order; an exception of one ends the calls."""
        for observer in self.observers:
            observer.on_update(count)

    def on_states(self, states: State) -> None:
        """Call `on_states` of all observers, in order; an exception of one ends the calls."""
        for observer in self.observers:
            observer.on_states(states)

    def on_episode_start(self, start: EpisodeStart) -> None:
        """Call `on_episode_start` of all observers, in order; an exception of one ends the calls."""
        for observer in self.observers:
            observer.on_episode_start(start)

    def on_episode_step(self, step: EpisodeStep) -> None:
        """Call `on_episode_step` of all observers, in order; an exception of one ends the calls."""
        for observer in self.observers:
            observer.on_episode_step(step)

    def on_episode_end(self, result: EpisodeResult) -> None:
        """Call `on_episode_end` of all observers, in order; an exception of one ends the calls."""
        for observer in self.observers:
            observer.on_episode_end(result)

    def on_log(self, line: Mapping[str, float]) -> None:
        """Call `on_log` of all observers, in order; an exception of one ends the calls."""
        for observer in self.observers:
            observer.on_log(line)

    def on_checkpoint(self, path: Path, steps: int) -> None:
        """Call `on_checkpoint` of all observers, in order; an exception of one ends the calls."""
        for observer in self.observers:
            observer.on_checkpoint(path, steps)

    def write(self, folder: Path) -> None:
        """Call `write` of all observers with the same folder, in order; an exception of one ends it."""
        for observer in self.observers:
            observer.write(folder)

    def close(self) -> None:
        """Close all observers in reverse order, also after an error of one; the error is raised at the end."""
        with ExitStack() as stack:
            for observer in self.observers:
                stack.callback(observer.close)


_REGISTRY: dict[str, Callable[[], Observer]] = {}


def register_observer(name: str, make_observer: Callable[[], Observer]) -> None:
    """Register an observer under its name; registering the same name again replaces it.

    Args:
        name: Name of the observer, for `home-mjx play --observe NAME` and `home-mjx train --observe NAME`.
        make_observer: Function without arguments that makes an observer for one run, such as its class.

    Raises:
        ConfigError: The name is empty, or `make_observer` cannot be called.
    """
    if not name or not callable(make_observer):
        raise ConfigError(f"an observer needs a name and a function that makes it, got {name!r} and {make_observer!r}")
    _REGISTRY[name] = make_observer


def find_observer(name: str) -> Observer:
    """Make a new observer by its registered name, else by that of an installed entry point, which is then registered.

    Raises:
        UnknownNameError: No observer has this name.
        ConfigError: The registered function makes something else.
    """
    if name not in _REGISTRY:
        if name not in installed(GROUP):
            raise UnknownNameError(
                f"unknown observer `{name}`", hint=did_you_mean(name, [*_REGISTRY, *installed(GROUP)])
            )
        register_observer(name, installed(GROUP)[name].load())
    return _checked(_REGISTRY[name]())


def resolve_observers(observers: Iterable[Observer | str]) -> tuple[Observer, ...]:
    """Return observers in the given order, made by name where a name is given; duplicates stay.

    Raises:
        UnknownNameError: No observer has this name.
        ConfigError: A value is neither an observer nor a name.
    """
    return tuple(find_observer(item) if isinstance(item, str) else _checked(item) for item in observers)


def _checked(item: Any) -> Observer:
    """Return an observer; `ConfigError` for others and for classes."""
    if not isinstance(item, Observer) or isinstance(item, type):
        raise ConfigError(f"expected an observer or its name, got {item!r}", hint="Derive its class from `Observer`.")
    return item
