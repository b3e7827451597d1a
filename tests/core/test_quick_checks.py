"""Annotations are checked for each way in which a function is called, and for each kind of result."""

from enum import Enum
from typing import Literal

import beartype
import jax
import jax.numpy as jnp
import numpy as np
import pytest
import quick_checks
from jaxtyping import Array, Float, PyTree, TypeCheckError, jaxtyped

CHECKER = beartype.beartype
checks = jaxtyped(typechecker=CHECKER)


@pytest.fixture(autouse=True)
def quick():
    assert jaxtyped is quick_checks.jaxtyped


def test_what_has_held_is_not_checked_again_and_what_is_new_is():
    @checks
    def scaled(x: Float[np.ndarray, "n 3"], by: Float[np.ndarray, " n"]) -> Float[np.ndarray, "n 3"]:
        return x * by[:, None]

    ways = quick_checks._functions[scaled.__wrapped__.__code__].ways
    for _ in range(5):
        scaled(np.ones((2, 3)), np.ones(2))
    assert len(ways) == 1
    scaled(np.ones((4, 3)), np.ones(4))
    assert len(ways) == 2
    for x, by in ((np.ones((2, 4)), np.ones(2)), (np.ones((2, 3)), np.ones(3)), (np.ones((2, 3), int), np.ones(2))):
        for _ in range(2):
            with pytest.raises(TypeCheckError):
                scaled(x, by)
    with pytest.raises(TypeCheckError):
        scaled([[1.0]], np.ones(1))
    assert len(ways) == 2


def test_results_are_checked_though_the_call_is_known():
    given = [np.ones(2), np.ones(3), {"a": 1}, np.ones(2)]

    @checks
    def drawn(n: int) -> Float[np.ndarray, " two"] | dict[str, int]:
        return given[n]

    @checks
    def wrong(n: int) -> Float[np.ndarray, "2"]:
        return given[n]

    assert [np.shape(drawn(n)) for n in range(4)] == [(2,), (3,), (), (2,)]
    for _ in range(2):
        with pytest.raises(TypeCheckError):
            wrong(1)
        with pytest.raises(TypeCheckError):
            wrong(2)
    assert wrong(0) is given[0]


def test_shapes_that_are_checked_in_their_turn_end():
    """A space of gymnax has a shape and a dtype by checked properties, and was looked into without end."""

    class Space:
        dtype = np.float32

        @property
        def shape(self) -> tuple[int, ...]:
            return given(self)

    @checks
    def given(space: Space) -> tuple[int, ...]:
        return (3,)

    assert [given(Space()), Space().shape, given(Space())] == [(3,)] * 3


def test_items_words_and_classes_are_told_apart_but_not_arrays_and_tracers_of_jax():
    @checks
    def all_of(items: tuple[int, ...] | dict[str, float], sort: type[Exception] = ValueError) -> str:
        return "ok"

    assert all_of((1, 2)) == all_of({"a": 1.0}) == all_of((), KeyError) == "ok"
    for wrong in (("a",), {"a": "b"}, {1: 1.0}, [1]):  # of many items beartype looks at one, by chance
        with pytest.raises(TypeCheckError):
            all_of(wrong)
    with pytest.raises(TypeCheckError):
        all_of((), int)

    @checks
    def norm(x: Float[Array, " n"]) -> Float[Array, ""]:
        return jnp.linalg.norm(x)

    jax.jit(norm)(jnp.ones(3))
    ways = quick_checks._functions[norm.__wrapped__.__code__].ways
    norm(jnp.ones(3))
    jax.vmap(norm)(jnp.ones((2, 3)))
    assert len(ways) == 1
    with pytest.raises(TypeCheckError):
        norm(np.ones(3, np.float32))
    with pytest.raises(TypeCheckError):
        jax.jit(norm)(jnp.ones((3, 1)))
    with pytest.raises(TypeCheckError):
        jax.jit(norm)(jnp.ones(3, int))


def test_words_count_only_for_hints_that_name_some():
    class Color(Enum):
        RED, BLUE = 1, 2

    @checks
    def length(word: str, color: Color = Color.RED) -> str:
        return word

    @checks
    def chosen(word: Literal["a", "b"] | None, color: Literal[Color.RED] = Color.RED) -> int:
        return 1

    for word in "abcde":
        assert length(word, Color.BLUE) == length(word) == word
    assert len(quick_checks._functions[length.__wrapped__.__code__].ways) == 2
    assert chosen("a") == chosen("b") == chosen(None) == 1
    for wrong in (("c",), ("a", Color.BLUE)):
        with pytest.raises(TypeCheckError):
            chosen(*wrong)


@pytest.mark.parametrize("sort", [list, set, dict.fromkeys])
def test_many_items_are_known_by_one_unless_a_hint_looks_at_all(sort):
    @checks
    def count(items: list[int] | set[int] | dict[int, None]) -> int:
        return len(items)

    @checks
    def leaves(items: PyTree[Float[np.ndarray, "3"]]) -> int:
        return len(items)

    ways = quick_checks._functions[count.__wrapped__.__code__].ways
    before = len(ways)
    assert [count(sort(range(n))) for n in (40, 50, 60)] == [40, 50, 60]
    assert len(ways) == before + 1
    for _ in range(2):
        with pytest.raises(TypeCheckError):
            count(sort(map(str, range(50))))
        assert leaves([np.ones(3)] * 40) == 40
        with pytest.raises(TypeCheckError):
            leaves([np.ones(3)] * 40 + [np.ones(2)])


def test_functions_within_others_share_what_is_known_and_keep_what_they_enclose():
    def made(factor):
        @checks
        def times(x: int, deeper: bool = False) -> int:
            return made(factor + 1)(x) if deeper else factor * x

        return times

    assert [made(k)(2) for k in range(3)] == [0, 2, 4]
    assert made(5)(2, deeper=True) == 12
    assert made(5)(2, deeper=True) == 12
    with pytest.raises(TypeCheckError):
        made(1)("a")


def test_hints_that_are_strings_are_checked():
    @checks
    def length(x: "np.ndarray") -> "int":
        return len(x) if len(x) < 3 else "many"

    assert length(np.ones(2)) == 2
    for wrong in ("ab", np.ones(3)):
        with pytest.raises(TypeCheckError):
            length(wrong)


def test_errors_are_those_of_the_function():
    @checks
    def refuse(n: int) -> int:
        raise KeyError(n)

    for _ in range(2):
        with pytest.raises(KeyError):
            refuse(1)
    with pytest.raises(TypeError):
        refuse()
