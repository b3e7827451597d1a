"""`home-mjx doctor`."""

import json

import pytest

from home_mjx.cli import main
from home_mjx.cli.commands import doctor


def findings(capsys: pytest.CaptureFixture) -> tuple[int, dict[str, dict]]:
    code = main(["doctor", "--json"])
    lines = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    return code, {line["topic"]: line for line in lines}


def test_sound_machine_is_ok(capsys: pytest.CaptureFixture, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.delenv("SUNCG_DATA_DIR", raising=False)
    code, found = findings(capsys)
    assert code == 0
    assert [f for f in found.values() if f["status"] == "broken"] == []
    assert found["jax"]["detail"] == __import__("jax").__version__
    assert found["ffmpeg"]["detail"].startswith("ffmpeg version")
    assert found["dataset"]["status"] == "note"


def test_wrong_dataset_folder_is_broken(capsys: pytest.CaptureFixture, monkeypatch: pytest.MonkeyPatch, tmp_path):
    monkeypatch.setenv("SUNCG_DATA_DIR", str(tmp_path / "nowhere"))
    code, found = findings(capsys)
    assert code == 1
    assert found["dataset"]["status"] == "broken"
    assert str(tmp_path / "nowhere") in found["dataset"]["detail"]


@pytest.mark.parametrize("below", [".", "sub"])
def test_cache_folder_that_is_a_file_is_broken(below: str, monkeypatch: pytest.MonkeyPatch, tmp_path):
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path / "file" / below))
    (found,) = [f for f in doctor._caches() if f.topic == "house cache"]
    assert found.status == "broken"
    assert "Not a directory. Set HOME_MJX_CACHE" in found.detail


def test_missing_package_is_broken(capsys: pytest.CaptureFixture, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(doctor, "_version", lambda name: None if name == "tqdm" else "9.9")
    code, found = findings(capsys)
    assert code == 1
    assert "pip install tqdm" in found["tqdm"]["detail"]


def test_brax_without_the_shim_is_named(monkeypatch: pytest.MonkeyPatch):
    import jax

    monkeypatch.delattr(jax, "device_put_replicated", raising=False)
    monkeypatch.setattr(doctor, "_version", {"brax": "0.14.2"}.get)
    (found,) = doctor._known_bad_pairs()
    assert found.status == "note"
    assert "brax_compat.install()" in found.detail
    monkeypatch.setattr(doctor, "_version", {"brax": "0.14.3"}.get)
    assert list(doctor._known_bad_pairs()) == []


def test_check_that_raises_is_a_finding(monkeypatch: pytest.MonkeyPatch):
    def _ffmpeg():
        raise RuntimeError("no binary")
        yield

    monkeypatch.setattr(doctor, "_ffmpeg", _ffmpeg)
    (found,) = [f for f in doctor.run_checks() if f.topic == "ffmpeg"]
    assert (found.status, found.detail) == ("broken", "RuntimeError: no binary")
