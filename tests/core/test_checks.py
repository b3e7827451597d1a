"""Checks of options: what is no number that computers calculate with is refused, in a short message."""

import math

import numpy as np
import pytest

from home_mjx.core.checks import check_number, check_type, names_hint, shorten
from home_mjx.errors import ConfigError


@pytest.mark.parametrize("value", [0, 5, 2**63 - 1, np.int32(7)])
def test_whole_numbers(value: int):
    check_number("n", value, 0, integer=True)


@pytest.mark.parametrize("value", [0, 0.5, 10**30, np.float32(2), -1e308])
def test_numbers(value: float):
    check_number("x", value)


@pytest.mark.parametrize("whole", [True, False])
@pytest.mark.parametrize(
    "value", [True, None, "1", math.nan, -math.inf, 10**400, -(10**400), 10**10_000, [1], 1j], ids=shorten
)
def test_what_is_no_number(value: object, whole: bool):
    with pytest.raises(ConfigError, match=r"^`n` must be a (whole|finite) number") as error:
        check_number("n", value, integer=whole)
    assert len(str(error.value)) < 150


@pytest.mark.parametrize("value", [2**63, 10**30])
def test_whole_numbers_have_64_bits(value: int):
    with pytest.raises(ConfigError, match="`n` must be"):
        check_number("n", value, 1, integer=True)


def test_long_values_are_cut_off():
    with pytest.raises(ConfigError, match=r"… \(5002 characters\)$"):
        check_type("n", "x" * 5000, int)


@pytest.mark.parametrize("text", ["depth, rgb", "[depth, rgb]", "['depth', \"rgb\"]", "(depth,rgb)"])
def test_hints_about_names_leave_out_brackets_and_quotes(text):
    """`[depth]` of a shell became `("(depth]",)`."""
    assert names_hint(text) == 'Write ("depth", "rgb"); on the command line NAME=["depth", "rgb"], in quotes.'
    assert names_hint("[depth]").startswith('Write ("depth",); ')
    assert names_hint("[]").startswith('Write ("...",); ')
