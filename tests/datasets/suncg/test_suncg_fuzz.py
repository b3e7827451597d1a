"""Damaged datasets, many of them: always a typed error that names file and element, in bounded time and memory.

Nothing is read outside of the dataset's root and nothing is written. Bugs found this way are tests of their own in
`test_suncg_found.py`.
"""

import json
import os
import resource

import pytest
from fuzz_corpus import (
    DOOR,
    HOUSE_ID,
    IMAGES,
    JSON_FILES,
    TEXT_FILES,
    Watch,
    compile_the_compiler,
    write_fuzz_dataset,
)
from fuzz_strategies import broken_bytes, broken_json, broken_text
from hypothesis import HealthCheck, given, settings

QUICK = settings(max_examples=8, suppress_health_check=list(HealthCheck))
LONG = settings(QUICK, max_examples=int(os.environ.get("HOME_MJX_FUZZ_CASES", "500")))  # for each target
SLOWEST = 5.0  # [s] of processor time, for one case
MOST = 400 << 10  # [KiB] by which memory may grow over all cases


@pytest.fixture(scope="module")
def watch(tmp_path_factory):
    return Watch(write_fuzz_dataset(tmp_path_factory.mktemp("fuzz")))


def fuzz(watch, name, strategy, profile):
    """Reads the dataset with one file replaced, over and over."""
    path = watch.root / name
    original = path.read_bytes()

    @profile
    @given(strategy(original))
    def run(data):
        path.write_bytes(data if isinstance(data, bytes) else data.encode("utf-8", "surrogatepass"))
        watch.read(name)

    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    try:
        run()
    finally:
        path.write_bytes(original)
    assert watch.worst < SLOWEST
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - peak < MOST
    print(f"{name}: {watch.report()}")  # noqa: T201


STRATEGIES = {
    "json": lambda data: broken_json(json.loads(data)),
    "text": lambda data: broken_text(data.decode()),
    "bytes": broken_bytes,
}
TARGETS = [
    *((name, "json") for name in JSON_FILES),
    *((name, "text") for name in TEXT_FILES),
    *((name, "bytes") for name in (*JSON_FILES, *TEXT_FILES, *IMAGES)),
]


def test_the_dataset_itself_is_sound(watch):
    watch.read()
    assert watch.errors == 0


@pytest.mark.parametrize(("name", "kind"), TARGETS)
def test_quickly(watch, name, kind):
    fuzz(watch, name, STRATEGIES[kind], QUICK)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "kind"), TARGETS)
def test_at_length(watch, name, kind):
    fuzz(watch, name, STRATEGIES[kind], LONG)


COMPILED = [
    *((name, "json") for name in JSON_FILES[:3]),
    (f"object/{DOOR}/{DOOR}_0.obj", "text"),
    (f"room/{HOUSE_ID}/fr_0rm_0w.obj", "text"),
]


@pytest.fixture
def compiling(watch):
    compile_the_compiler()
    watch.compiles = True
    yield
    watch.compiles = False


@pytest.mark.parametrize(("name", "kind"), COMPILED)
def test_what_can_be_read_is_compiled_quickly(watch, compiling, name, kind):
    fuzz(watch, name, STRATEGIES[kind], settings(QUICK, max_examples=5))


@pytest.mark.slow
@pytest.mark.parametrize(("name", "kind"), COMPILED)
def test_what_can_be_read_is_compiled_at_length(watch, compiling, name, kind):
    fuzz(watch, name, STRATEGIES[kind], LONG)


def test_most_damage_is_noticed(watch):
    """The strategies do break things: else the tests above would show nothing."""
    before = watch.cases, watch.errors
    fuzz(watch, JSON_FILES[0], STRATEGIES["json"], settings(QUICK, max_examples=30))
    fuzz(watch, TEXT_FILES[0], STRATEGIES["text"], settings(QUICK, max_examples=30))
    assert (watch.errors - before[1]) / (watch.cases - before[0]) > 0.3
    assert len(watch.messages) > 10
