"""Fields that hold one of several records, of a user's own dataclasses."""

from dataclasses import dataclass, field, replace

import pytest

from home_mjx.core.variants import check_variants, nested_names, override_fields, variant_metadata
from home_mjx.errors import ConfigError, UnknownNameError


@dataclass(frozen=True)
class Ball:
    radius: float = 1.0
    mass: float = 1.0


@dataclass(frozen=True)
class Box:
    edge: float
    mass: float = 1.0


@dataclass(frozen=True)
class Tray:
    height: float = 0.5


@dataclass(frozen=True)
class Thing:
    name: str = "thing"
    shape: Ball | Box = field(default_factory=Ball, metadata=variant_metadata({"ball": Ball, "box": Box}))
    tray: Tray | None = field(default=None, metadata=variant_metadata({True: Tray, False: None}))
    lid: Tray = field(default_factory=Tray)

    def __post_init__(self):
        check_variants(self)


def test_words_select_records_and_names_change_them():
    assert override_fields(Thing(), {"shape": "box", "edge": 2.0}) == Thing(shape=Box(2.0))
    assert override_fields(Thing(), {"radius": 3, "name": "x"}) == Thing("x", Ball(3))
    heavy = Thing(shape=Ball(mass=7.0), tray=Tray(2.0))
    assert override_fields(heavy, {"shape": "ball", "tray": True}) == heavy  # what is selected already stays
    assert override_fields(heavy, {"shape": Box(1.0), "mass": 2.0}) == replace(heavy, shape=Box(1.0, 2.0))
    assert (
        override_fields(heavy, {"tray": None}) == override_fields(heavy, {"tray": False}) == replace(heavy, tray=None)
    )
    assert nested_names(Thing(), "shape") == ("radius", "mass", "edge")
    assert nested_names(Thing(), "name") == ()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"shape": "bal"}, "unknown `shape` 'bal'. Did you mean `ball`"),
        ({"tray": 1}, "unknown `tray` 1"),
        ({"shape": []}, r"unknown `shape` \[\]"),
        ({"edge": 1.0}, "`shape.edge` has no effect with Ball. Set `shape` to 'box' too"),
        ({"shape": "box", "edge": 1.0, "radius": 1.0}, "`shape.radius` has no effect with Box"),
        ({"radios": 1.0}, "unknown option `radios`. Did you mean `radius`"),
        ({"height": 1.0}, "unknown option `height`"),  # of the tray or of the lid
        ({"lid": 3}, "`lid` must be of type Tray, got 3"),
    ],
)
def test_options_without_effect_and_unknown_ones_are_refused(changes, message):
    with pytest.raises(ConfigError, match=message) as caught:
        override_fields(Thing(), changes)
    assert isinstance(caught.value, UnknownNameError) == message.startswith("unknown")


@pytest.mark.parametrize("wrong", [{"shape": "box"}, {"shape": Box}, {"shape": None}, {"tray": True}])
def test_constructors_take_records_only(wrong):
    with pytest.raises(ConfigError, match=r"must be (Ball\(\.\.\.\) or Box|Tray\(\.\.\.\) or None)"):
        Thing(**wrong)
