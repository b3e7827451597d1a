"""Questions about houses: each answer is found again from the question's text and the bank's tables."""

import re

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from spoken_words import number

import home_mjx
from home_mjx.errors import ConfigError
from home_mjx.houses import load_bank
from home_mjx.schema.semantic import Semantic
from home_mjx.schema.vocabulary import vocabularies
from home_mjx.tasks.language import detokenize
from home_mjx.tasks.language.phrases import SEMANTIC_COLUMN
from home_mjx.tasks.language.vocabulary import to_word
from home_mjx.tasks.metrics import chance_accuracy, prior_accuracy
from home_mjx.tasks.questions.question_kinds import MAX_GAP_NEXT_TO
from home_mjx.tasks.rules.enums import ANY, NUM_DESCRIPTORS, Attribute, TargetKind
from home_mjx.tasks.rules.house_view import house_views
from home_mjx.tasks.rules.resolve import resolve_targets_on_host
from home_mjx.tasks.suite import VQA, HouseQA

THE = r"the (?:\w+ )*?\w+(?: in the \w+)?"
ASKED = {"colour": Semantic.COLOR, "material": Semantic.MATERIAL, "size": Semantic.SIZE, "room": Semantic.ROOM_TYPE}


@pytest.fixture(scope="module")
def bank():
    return load_bank("procedural:4?preset=flat")


@pytest.fixture(scope="module")
def tasks(bank):
    return HouseQA(num_tasks=40).task_bank(bank)


def asked(tasks):
    columns = tasks.rows.columns
    texts = [detokenize(row) for row in np.asarray(columns["tokens"])]
    answers = [detokenize([token]) for token in np.asarray(columns["answer"]).tolist()]
    return list(zip(np.asarray(tasks.rows.house).tolist(), texts, answers, strict=True))


def descriptor(phrase):
    """A row of words from a phrase such as `definite_noun pack_field red chair in definite_noun kitchen`."""
    found = np.full(len(Attribute), ANY, np.int32)
    found[Attribute.KIND] = TargetKind.OBJECT
    body, _, room = phrase.removeprefix("the ").partition(" in the ")
    *adjectives, noun = body.split()
    found[Attribute.COARSE] = number(Attribute.COARSE, noun)
    if room:
        found[Attribute.ROOM_TYPE] = number(Attribute.ROOM_TYPE, room)
    for adjective in adjectives:
        word = next(
            w
            for w in (Attribute.SIZE, Attribute.COLOR, Attribute.MATERIAL)
            if adjective in map(to_word, vocabularies()[SEMANTIC_COLUMN[w]]) and found[w] == ANY
        )
        found[word] = number(word, adjective)
    return found


class Looker:
    """Answers a text by masks of what it means in a house."""

    def __init__(self, bank):
        self.bank = bank
        self.boxes = {view.house: {t.object_id: t.box for t in view.objects} for view in house_views(bank)}

    def objects(self, house, *phrases):
        """Rows of the semantic table of what the first phrase means; further ones are what it refers to."""
        whole = np.full((1, NUM_DESCRIPTORS, len(Attribute)), ANY, np.int32)
        for at, phrase in enumerate(phrases):
            whole[0, at] = phrase if isinstance(phrase, np.ndarray) else descriptor(phrase)
        mask = resolve_targets_on_host(self.bank, house, whole).instance[0, 0]
        rows = np.asarray(self.bank.semantics)[np.asarray(self.bank.geometry.instance_semantic[house])[mask]]
        return {int(row[Semantic.OBJECT_ID]): row for row in rows}

    def one(self, house, phrase):
        found = self.objects(house, phrase)
        assert len(found) == 1, phrase
        return next(iter(found.items()))

    def on(self, house, category, bearer):
        upper = descriptor(f"the {category}")
        upper[Attribute.ON] = 1
        return self.objects(house, upper, bearer)

    def pair(self, house, a, b):
        (first, row), (second, other) = self.one(house, a), self.one(house, b)
        return self.boxes[house][first], self.boxes[house][second], row, other


def yes(condition):
    return "yes" if condition else "no"


def answer(look, house, text):
    """The answer by another way than the generator's: from the text alone."""
    if match := re.fullmatch(r"(?:is there|does the (?P<r>\w+) have) an? (?P<c>\w+)(?: in the (?P<s>\w+))?", text):
        return yes(look.objects(house, f"the {match['c']} in the {match['r'] or match['s']}"))
    if match := re.fullmatch(r"(?:how many|what is the number of) (\w+)(?: are there)? in the (\w+)", text):
        return str(len(look.objects(house, f"the {match[1]} in the {match[2]}")))
    if match := re.fullmatch(rf"is there an? (\w+) on ({THE})", text):
        return yes(look.on(house, match[1], match[2]))
    if match := re.fullmatch(rf"does ({THE}) have an? (\w+) on it", text):
        return yes(look.on(house, match[2], match[1]))
    if match := re.fullmatch(rf"(?:what|which thing) is on ({THE})", text):
        names = [to_word(name) for name in vocabularies()[Semantic.COARSE]]
        found = [name for name in dict.fromkeys(names) if look.on(house, name, match[1])]
        assert len(found) == 1
        return found[0]
    for pattern, attribute in (
        (rf"(?:what colour is|what is the colour of) ({THE})", "colour"),
        (rf"what is ({THE}) made of|of which material is ({THE})", "material"),
        (rf"(?:what size is|what is the size of) ({THE})", "size"),
        (rf"(?:in which room|where) is ({THE})", "room"),
    ):
        if match := re.fullmatch(pattern, text):
            _, row = look.one(house, next(group for group in match.groups() if group))
            return to_word(vocabularies()[ASKED[attribute]][row[ASKED[attribute]]])
    return compared(look, house, text)


def compared(look, house, text):
    if match := re.fullmatch(r"is (the \w+) (larger|smaller) than (the \w+)", text):
        a, b, _, _ = look.pair(house, match[1], match[3])
        return yes((np.prod(a[1] - a[0]) > np.prod(b[1] - b[0])) == (match[2] == "larger"))
    if match := re.fullmatch(
        r"(?:is|do) (the \w+) (?:the same colour as|and) (the \w+)(?: have the same colour)?", text
    ):
        _, _, a, b = look.pair(house, match[1], match[2])
        return yes(a[Semantic.COLOR] == b[Semantic.COLOR])
    match = re.fullmatch(r"is (the \w+) (?:next to|near) (the \w+)", text)
    assert match, text
    a, b, _, _ = look.pair(house, match[1], match[2])
    apart = np.maximum(np.maximum(a[0] - b[1], b[0] - a[1]), 0)
    return yes(np.linalg.norm(apart) <= MAX_GAP_NEXT_TO)


def test_answers_are_found_again_from_texts_and_masks(bank, tasks):
    look = Looker(bank)
    wrong = [(house, text, said) for house, text, said in asked(tasks) if answer(look, house, text) != said]
    assert wrong == []
    assert len(tasks) >= 60


def test_all_kinds_are_asked_in_all_houses(bank, tasks):
    starts = {" ".join(text.split()[:2]) for _, text, _ in asked(tasks)}
    assert len(starts) >= 10
    counts = np.bincount(np.asarray(tasks.rows.house), minlength=bank.num_houses)
    assert counts.min() >= 5
    assert counts.max() <= 40


def test_the_best_that_only_reads_is_at_chance(tasks):
    assert prior_accuracy(tasks, tasks) == pytest.approx(chance_accuracy(tasks), abs=1e-12)
    assert 0.2 < chance_accuracy(tasks) <= 0.5


@pytest.mark.slow
def test_the_best_that_only_reads_is_at_chance_in_houses_that_it_has_not_met():
    learned, held_out = (
        HouseQA().task_bank(load_bank("procedural:65536?preset=flat", num_houses=8, split=split))
        for split in ("train", "test")
    )
    for tasks in (learned, held_out):
        assert prior_accuracy(tasks, tasks) == pytest.approx(chance_accuracy(tasks), abs=1e-12)
    assert len(held_out) > 100
    assert prior_accuracy(learned, held_out) <= chance_accuracy(held_out) + 1e-12


def test_what_is_told_gives_no_answer_away(tasks):
    """Words of what is to be looked at never hold the one that is asked about."""
    columns = tasks.rows.columns
    words = np.asarray(columns["descriptor"])[:, 0]
    for (_, text, _), own in zip(asked(tasks), words, strict=True):
        for start, word in (
            ("what colour", Attribute.COLOR),
            ("of which material", Attribute.MATERIAL),
            ("where", Attribute.ROOM_TYPE),
        ):
            assert not text.startswith(start) or own[word] == ANY
        assert own[Attribute.OBJECT_ID] == ANY


def test_views_show_what_they_are_asked_about(bank):
    """The environment's own images: what is in view is what the answers say."""
    env = home_mjx.make("VQA-v0", bank, sensors=("coarse", "color", "instance"), num_tasks=16, num_views=12)
    tasks = env.params.tasks
    keys, rows = jax.random.split(jax.random.key(0), len(tasks)), jnp.arange(len(tasks))
    obs = jax.jit(jax.vmap(lambda p, k, i: env.core.reset(p, k, None, i).obs, (None, 0, 0)))(env.params, keys, rows)
    seen = {name.partition("_")[2]: np.asarray(value) for name, value in obs.items()}
    kinds = set()
    for at, (_, text, said) in enumerate(asked(tasks)):
        if match := re.fullmatch(r"(?:do you see|is there) an? (\w+)(?: here)?", text):
            assert said == yes((seen["coarse"][at] == number(Attribute.COARSE, match[1])).any())
            kinds.add(said)
        elif match := re.fullmatch(r"how many (\w+) (?:do you see|are there)", text):
            mine = seen["coarse"][at] == number(Attribute.COARSE, match[1])
            assert said == str(len(np.unique(seen["instance"][at][mine])))
            kinds.add("count")
        elif match := re.fullmatch(r"what (?:colour is|is the colour of) the (\w+)", text):
            mine = seen["coarse"][at] == number(Attribute.COARSE, match[1])
            assert {said} == {vocabularies()[Semantic.COLOR][c] for c in np.unique(seen["color"][at][mine])}
            kinds.add("colour")
    assert kinds == {"yes", "no", "count", "colour"}
    assert prior_accuracy(tasks, tasks) == pytest.approx(chance_accuracy(tasks), abs=1e-12)


def test_kinds_say_which_words_answer():
    task = HouseQA(kinds=("size", "count"))
    assert task.speech == tuple(f"answer:{w}" for w in ("tiny", "small", "normal", "large", "huge", *"123456"))
    assert len(HouseQA().speech) == len(set(HouseQA().speech)) > 100
    for wrong in (HouseQA, VQA):
        with pytest.raises(ConfigError, match="kind of question"):
            wrong(kinds=("colours",))
    with pytest.raises(ConfigError, match="kind of question"):
        VQA(kinds=("location",))


def test_one_house_asks_nothing(bank):
    with pytest.raises(ConfigError, match="two answers in 1 houses"):
        HouseQA().task_bank(load_bank("procedural:1?preset=flat"))
