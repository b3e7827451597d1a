"""Task to switch a lamp or an appliance on or off."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from home_mjx.bank.records import SWITCH_KINDS
from home_mjx.core.checks import check_known
from home_mjx.errors import ConfigError
from home_mjx.tasks.language.phrases import draw_identifying_words, noun_phrase
from home_mjx.tasks.language.vocabulary import tokenize
from home_mjx.tasks.rules.build_bank import TaskRow
from home_mjx.tasks.rules.enums import FAILURE, SUCCESS, Attribute, Feature
from home_mjx.tasks.rules.house_view import HouseObject, HouseView
from home_mjx.tasks.rules.program import Condition, Selector, TaskStage, Transition
from home_mjx.tasks.suite.navigation import STOP_CONDITION, NavigationTask

VERBS = ("turn", "switch")
Words = dict[Attribute, int]


@dataclass(frozen=True)
class Toggle(NavigationTask):
    """Switch one thing on, or off, that words identify; it begins in the opposite state.

    Attributes:
        kinds: Kinds of things, from `SWITCH_KINDS`.
    """

    kinds: tuple[str, ...] = SWITCH_KINDS

    def __post_init__(self) -> None:
        super().__post_init__()
        if not isinstance(self.kinds, tuple) or not self.kinds:
            raise ConfigError(f"`kinds` must be a tuple of {', '.join(SWITCH_KINDS)}, got {self.kinds!r}")
        check_known("kind", self.kinds, SWITCH_KINDS)

    @property
    def requires_hands(self) -> bool:
        """Always True."""
        return True

    @property
    def requires_switches(self) -> bool:
        """Always True."""
        return True

    def rows(self, view: HouseView, random: np.random.Generator) -> Iterator[TaskRow]:
        """Yield rows, endlessly: all kinds in the house equally often, and each thing as often on as off.

        None if no hand reaches anything of `kinds` that words identify.
        """
        told = self._describe_things(view, random)
        while told:
            for kind in random.permutation(list(told)).tolist():
                thing = told[kind].pop(0)
                told[kind].append(thing)
                for is_on in random.permutation(2).tolist():
                    yield self._row(thing, bool(is_on), VERBS[int(random.integers(len(VERBS)))])

    def _describe_things(self, view: HouseView, random: np.random.Generator) -> dict[int, list[Words]]:
        """Return words that identify each thing within reach, by its kind, in random order."""
        switches, found = view.bank.switches, {}
        kind_of = dict(
            zip(*(np.asarray(x[view.house]).tolist() for x in (switches.instance, switches.kind)), strict=True)
        )
        wanted = {SWITCH_KINDS.index(name) for name in self.kinds}
        for at in random.permutation(len(view.objects)).tolist():
            thing: HouseObject = view.objects[at]
            instance = view.instance_of(thing)
            kind = kind_of.get(instance, -1) if instance >= 0 else -1
            if kind in wanted and len(view.touch_cells(instance)[0]):
                words = draw_identifying_words(view.objects, thing, random)
                if words is not None:
                    found.setdefault(kind, []).append(words)
        return found

    def _row(self, words: Words, is_on: bool, verb: str) -> TaskRow:
        """Return the row with two stages: change the state, then stop; without `stop` only the first.

        Half of `success_reward` is paid for each; changing the state back takes the first half back and begins anew.
        """
        done = Condition(Feature.SWITCHED_ON, 0, minimum=1) if is_on else Condition(Feature.SWITCHED_ON, 0, maximum=0)
        tokens = tokenize(f"{verb} {'on' if is_on else 'off'} {noun_phrase(words)}")
        return TaskRow([Selector.objects_with(words)], self._stages(done), tokens=tokens)

    def _stages(self, done: Condition) -> list[TaskStage]:
        """Return the stages to make a condition true, and to stop then."""
        if not self.stop:
            return [TaskStage((Transition(SUCCESS, (done,), reward=self.success_reward),), guide=0)]
        half, wrong = self.success_reward / 2, Transition(FAILURE, (STOP_CONDITION,))
        first = TaskStage((Transition(1, (done,), reward=half), wrong), guide=0)
        last = Transition(SUCCESS, (done, STOP_CONDITION), reward=half)
        return [first, TaskStage((last, wrong, Transition(0, forbid=(done,), reward=-half)), guide=0)]
