"""Files and folders written whole or not at all."""

import pytest

from home_mjx.core.files import replace_folder, write_whole


def test_a_file_takes_its_place_when_it_is_whole(tmp_path):
    path = tmp_path / "new" / "a"
    with write_whole(path) as file:
        file.write(b"one")
        file.flush()
        assert not path.exists()
    assert path.read_bytes() == b"one"
    with write_whole(path) as file:
        file.write(b"two")
        file.flush()
        assert path.read_bytes() == b"one"
    assert path.read_bytes() == b"two"
    assert list(path.parent.iterdir()) == [path]


def test_what_fails_half_way_leaves_the_old_file(tmp_path):
    path = tmp_path / "a"
    path.write_bytes(b"old")

    def interrupted() -> None:
        with write_whole(path) as file:
            file.write(b"half")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_folder_is_replaced_with_all_that_was_in_it(tmp_path):
    target = tmp_path / "house"
    replace_folder(target, {"a": b"1", "sub/b": b"2"})
    assert {p.relative_to(target).as_posix() for p in target.rglob("*") if p.is_file()} == {"a", "sub/b"}
    replace_folder(target, {"c": b"3"})
    assert [p.name for p in target.iterdir()] == ["c"]
    with pytest.raises(OSError, match="c"):
        replace_folder(target, {"c": b"4", "c/d": b"5"})
    assert (target / "c").read_bytes() == b"3"
    assert list(tmp_path.iterdir()) == [target]
