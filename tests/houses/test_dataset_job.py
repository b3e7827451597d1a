"""Compiling whole datasets: bad houses, kills, resuming, worker processes, a cluster."""

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from full_disk import full_disk
from processes import processes_of, wait_for
from tiny_dataset import edit_house, write_tiny_dataset

from home_mjx.cli import main
from home_mjx.core.array_store import read_entry
from home_mjx.datasets.registry import open_dataset
from home_mjx.errors import ConfigError, DatasetError
from home_mjx.houses import pools as executors
from home_mjx.houses.house_cache import HouseCache
from home_mjx.houses.job import compile_dataset
from home_mjx.houses.report import CompileOutcome, load_report, open_journal, read_report
from home_mjx.scene_compile.collision.movables import MovableOptions
from home_mjx.scene_compile.pipeline.compile import CompileOptions

NUM_HOUSES = 12


@pytest.fixture(scope="module")
def houses(tmp_path_factory) -> tuple[Path, tuple[str, ...]]:
    root = write_tiny_dataset(tmp_path_factory.mktemp("houses"))
    ids = tuple(f"{i:032x}" for i in range(1, NUM_HOUSES + 1))
    for house_id in ids[1:]:
        for folder in ("house", "room"):
            shutil.copytree(root / folder / ids[0], root / folder / house_id)
        edit_house(root, lambda house, i=house_id: house.update(id=i), house_id)
    return root, ids


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch) -> Path:
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache"


def broken_copy(root: Path, ids: tuple[str, ...], target: Path) -> tuple[Path, str]:
    """The same dataset, one of whose houses has lost its end."""
    target.mkdir()
    for folder in ("object", "texture", "metadata", "room"):
        (target / folder).symlink_to(root / folder)
    for house in ids:
        path = target / "house" / house / "house.json"
        path.parent.mkdir(parents=True)
        path.write_bytes((root / "house" / house / "house.json").read_bytes())
    bad = ids[2]
    path = target / "house" / bad / "house.json"
    path.write_bytes(path.read_bytes()[:500])
    return target, bad


def content(folder: Path) -> dict[str, bytes]:
    """Every entry of a cache."""
    return {str(p.relative_to(folder)): p.read_bytes() for p in folder.glob("*/*.zip")}


def test_all_houses_come_into_the_cache(houses):
    root, ids = houses
    first, second = compile_dataset(root), compile_dataset(root)
    assert (first.compiled, first.cached, first.failed, first.skipped) == (NUM_HOUSES, 0, 0, 0)
    assert (second.compiled, second.cached) == (0, NUM_HOUSES)
    lines = read_report(second.report)
    assert [line["id"] for line in lines] == list(ids)
    assert {line["status"] for line in lines} == {"cached"}
    third = compile_dataset(root, resume=True)
    assert (third.skipped, third.compiled + third.cached) == (NUM_HOUSES, 0)


def test_objects_beyond_the_most_bodies_are_counted(houses, capsys):
    root, ids = houses
    none = CompileOptions(movables=MovableOptions(max_bodies=0))
    (first, again), free = (
        (compile_dataset(root, ids[:2], options=none) for _ in range(2)),
        compile_dataset(root, ids[:2]),
    )
    assert first.fixed == again.fixed == 2 * compiled_bodies(root, ids[0]) > 0
    assert free.fixed == 0
    assert sum(line["fixed"] for line in read_report(again.report)[-2:]) == again.fixed  # two runs add to it
    assert main(["compile", str(root), "--workers", "1", "--max-bodies", "0"]) == 0
    assert f"{NUM_HOUSES * first.fixed // 2} movable objects are fixed" in capsys.readouterr().out


def compiled_bodies(root: Path, house_id: str) -> int:
    return HouseCache(open_dataset(root)).load(house_id).report["bodies"]


def test_a_bad_house_is_reported_and_stops_nothing(houses, tmp_path, capsys):
    root, bad = broken_copy(*houses, tmp_path / "data")
    summary = compile_dataset(root)
    assert (summary.compiled, summary.failed) == (NUM_HOUSES - 1, 1)
    (line,) = [line for line in read_report(summary.report) if line["status"] == "failed"]
    assert line["id"] == bad
    assert line["error"]["type"] == "DatasetError"
    assert line["error"]["file"].endswith(f"{bad}/house.json")
    assert line["error"]["hint"]
    again = compile_dataset(root, resume=True)  # tried again: it may have been mended
    assert (again.skipped, again.failed) == (NUM_HOUSES - 1, 1)
    assert main(["compile", str(root), "--workers", "1", "--resume"]) == 1
    assert bad in capsys.readouterr().err


def test_what_is_unknown_is_refused(houses, monkeypatch):
    with pytest.raises(DatasetError, match="unknown house"):
        compile_dataset(houses[0], ["nowhere"])
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(ConfigError, match=r"pip install '\.\[distributed\]'"):
        compile_dataset(houses[0], scheduler="tcp://127.0.0.1:1")


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:1", "nowhere", "xyz://a"])
def test_a_scheduler_that_does_not_answer_is_told_of_and_the_report_stays(houses, monkeypatch, address):
    pytest.importorskip("distributed")
    monkeypatch.setattr(executors, "CONNECT_TIMEOUT", 1)
    report = compile_dataset(houses[0]).report
    before = report.read_bytes()
    with pytest.raises(ConfigError, match="no Dask scheduler answers"):
        compile_dataset(houses[0], scheduler=address)
    assert report.read_bytes() == before


def test_a_cut_line_of_the_report_is_passed_over(houses):
    root, ids = houses
    report = compile_dataset(root).report
    report.write_bytes(report.read_bytes()[:-20])
    summary = compile_dataset(root, resume=True)
    assert (summary.skipped, summary.cached) == (NUM_HOUSES - 1, 1)
    assert sorted(line["id"] for line in read_report(report)) == list(ids)


def test_a_cache_that_cannot_be_written_to_is_told_of(houses, tmp_path, monkeypatch):
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path / "file"))
    with pytest.raises(ConfigError, match=r"/file\)\. Set HOME_MJX_CACHE"):
        compile_dataset(houses[0])


@pytest.mark.parametrize("workers", [0, -1])
def test_no_workers_are_refused(houses, workers):
    with pytest.raises(ConfigError, match=f"got {workers}"):
        compile_dataset(houses[0], workers=workers)


def test_a_report_that_cannot_be_written_is_found_before_the_work(houses, cache, tmp_path):
    with pytest.raises(ConfigError, match=r"report cannot be written.*Name a new file"):
        compile_dataset(houses[0], report=tmp_path)
    assert not list(cache.glob("*/houses/*"))


def test_what_the_cache_has_lost_is_compiled_again(houses, cache, tmp_path):
    root, ids = houses
    options = {"ids": ids[:2], "report": tmp_path / "report.jsonl"}
    assert compile_dataset(root, **options).compiled == 2
    next(cache.glob("*/houses/*.zip")).unlink()
    summary = compile_dataset(root, **options, resume=True)
    assert (summary.skipped, summary.compiled) == (1, 1)


def test_entries_that_were_cut_off_are_compiled_again(houses, cache):
    root, _ = houses
    compile_dataset(root)
    first, second, *_ = cache.glob("*/houses/*.zip")
    first.write_bytes(first.read_bytes()[:-100])
    second.write_bytes(b"")
    summary = compile_dataset(root, resume=True)
    assert (summary.compiled, summary.skipped, summary.failed) == (2, NUM_HOUSES - 2, 0)


def test_a_run_of_one_house_adds_to_the_report(houses):
    root, ids = houses
    compile_dataset(root)
    compile_dataset(root, ids[:1])
    assert compile_dataset(root, resume=True).skipped == NUM_HOUSES


def test_a_run_that_was_killed_in_its_first_line_goes_on(tmp_path):
    """At whatever byte; also if the next one was killed there as well."""
    path = tmp_path / "report.jsonl"
    with open_journal(path, append=False) as note:
        note(CompileOutcome("a" * 32, "compiled", 1.0, entry="v/houses/a.zip"))
    line = path.read_bytes()
    for count in range(len(line)):
        for content in (line[:count], line[:count] + b"\n" + line[: count // 2]):
            path.write_bytes(content)
            assert load_report(path) == [] or count == len(line) - 1
            with open_journal(path, append=True) as note:
                note(CompileOutcome("b" * 32, "cached", 1.0))
            assert load_report(path)[-1]["id"] == "b" * 32


def test_two_runs_into_one_report_keep_each_others_lines(tmp_path):
    path = tmp_path / "report.jsonl"
    with open_journal(path, append=True) as one, open_journal(path, append=True) as other:
        for number in range(50):
            one(CompileOutcome(f"{2 * number:032x}", "compiled", 1.0))
            other(CompileOutcome(f"{2 * number + 1:032x}", "compiled", 1.0))
    assert [line["id"] for line in load_report(path)] == [f"{number:032x}" for number in range(100)]


def test_a_full_disk_is_said_with_the_file_that_it_lacks(houses):
    root, ids = houses
    with full_disk(3000):
        summary = compile_dataset(root, ids[:1])
    line = read_report(summary.report)[-1]
    assert (summary.failed, line["error"]["type"]) == (1, "ConfigError")
    assert line["error"]["file"].endswith(".zip")
    assert line["error"]["hint"].startswith("Free some space")
    assert compile_dataset(root, ids[:1], resume=True).failed == 0


@pytest.mark.parametrize("content", [b"my notes\n", b'{"a": 1}\n', b"\xff\xfe\x00", b"[1]\n"])
@pytest.mark.parametrize("resume", [False, True])
def test_a_file_that_is_no_report_is_kept(houses, tmp_path, content, resume):
    path = tmp_path / "notes.txt"
    path.write_bytes(content)
    with pytest.raises(ConfigError, match="not a report"):
        compile_dataset(houses[0], report=path, resume=resume)
    assert path.read_bytes() == content


def test_without_dask_the_old_report_stays(houses, tmp_path, monkeypatch):
    root, ids = houses
    report = compile_dataset(root, ids[:1]).report
    before = report.read_bytes()
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(ConfigError, match="needs the package"):
        compile_dataset(root, scheduler="tcp://127.0.0.1:1")
    assert report.read_bytes() == before


def job(root: Path, *options: str) -> subprocess.Popen:
    command = [sys.executable, "-m", "home_mjx.cli", "compile", str(root), *options]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


@pytest.mark.skipif(not Path("/proc/self/environ").exists(), reason="looks for orphans in /proc")
@pytest.mark.parametrize("moments", [(2,), pytest.param((0, 2, 6), marks=pytest.mark.slow)], ids=["once", "thrice"])
def test_kills_lose_nothing_and_break_nothing(houses, tmp_path, monkeypatch, moments):
    """Killed after some entries, or while one is written; then left to end. `make crash` kills at each write."""
    root, ids = houses
    cache = tmp_path / "killed"
    monkeypatch.setenv("HOME_MJX_CACHE", str(cache))
    for entries in moments:
        process = job(root, "--workers", "2", "--resume")
        wait_for(lambda n=entries: len(list(cache.glob("*/houses/*.zip"))) > n or list(cache.glob("*/*/.*.tmp")))
        process.send_signal(signal.SIGKILL)
        process.wait()
        wait_for(lambda: not processes_of(cache))  # the workers leave with their parent
        for path in cache.glob("*/*/*.zip"):
            read_entry(path)
    assert job(root, "--workers", "2", "--resume").wait(timeout=120) == 0
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path / "undisturbed"))
    assert compile_dataset(root).failed == 0
    (report,) = (tmp_path / "undisturbed").glob("*/reports/*.jsonl")
    report = report.relative_to(tmp_path / "undisturbed")
    resumed, undisturbed = ((folder / report.parts[0]) for folder in (cache, tmp_path / "undisturbed"))
    assert content(resumed) == content(undisturbed) != {}
    assert {line["id"] for line in read_report(cache / report)} == set(ids)


def _deadly(house_id: str) -> CompileOutcome:
    if house_id == "deadly":
        os.kill(os.getpid(), signal.SIGKILL)
    time.sleep(0.05)
    return CompileOutcome(house_id, "compiled", 0.05)


def test_a_house_that_kills_its_worker_fails_alone():
    ids = [f"a{i}" for i in range(5)] + ["deadly"] + [f"b{i}" for i in range(5)]
    found = {o.id: o for o in executors._in_processes(_deadly, ids, 2)}
    assert sorted(found) == sorted(ids)
    assert [i for i, o in found.items() if o.status == "failed"] == ["deadly"]
    assert "died" in found["deadly"].error["message"]


@pytest.mark.slow
def test_a_cluster_does_the_same_work(houses, tmp_path, monkeypatch):
    distributed = pytest.importorskip("distributed")
    root, bad = broken_copy(*houses, tmp_path / "data")
    alone = compile_dataset(root)
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path / "cluster"))
    options = {"n_workers": 2, "threads_per_worker": 1, "processes": True, "dashboard_address": None}
    with distributed.LocalCluster(**options) as cluster:
        summary = compile_dataset(root, scheduler=cluster.scheduler_address)
    assert (summary.compiled, summary.failed) == (NUM_HOUSES - 1, 1)
    version = alone.report.parent.parent.name
    assert content(tmp_path / "cluster" / version) == content(tmp_path / "cache" / version) != {}
    assert {line["id"] for line in read_report(summary.report)} == {line["id"] for line in read_report(alone.report)}
    assert json.loads(json.dumps(read_report(summary.report))) == read_report(summary.report)
    assert [line["id"] for line in read_report(summary.report) if line["status"] == "failed"] == [bad]


def test_a_script_without_a_guard_compiles_in_worker_processes(houses, tmp_path):
    """Workers do not import it, since nothing of the job is defined there."""
    script = tmp_path / "script.py"
    script.write_text(
        f"from home_mjx.houses import compile_dataset\nprint(compile_dataset({str(houses[0])!r}, workers=2).compiled)\n"
    )
    done = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, timeout=240, check=True)
    assert done.stdout.split() == [str(NUM_HOUSES)]
