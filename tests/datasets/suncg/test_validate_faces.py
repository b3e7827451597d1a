"""Findings of the validator in OBJ and MTL files."""

import pytest
from tiny_dataset import HOUSE_ID, TABLE, write_tiny_dataset

from home_mjx.datasets import open_dataset, validate_house
from home_mjx.datasets.suncg.validate.faces import _ambiguous_opacities, _unread_statements

SHEET = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"
FRAME = "v 2 2 0\nv 6 2 0\nv 6 5 0\nv 2 5 0\nv 3 3 0\nv 3 4 0\nv 5 4 0\nv 5 3 0\n"
CASES = {
    f"{FRAME}f -8 -7 -6 -5 -8 -4 -3 -2 -1 -4\n": ("bridged-face", "1 of the faces visit a corner twice"),
    "v 0 0 0\nv 1 0 0\nv 1 1 0.1\nv .5 2 0\nv 0 1 0\nf -5 -4 -3 -2 -1\n": ("bent-face", "1 of the faces are bent"),
    "v 0 0 0 1 0 0\n": ("unread-statement", "colours of vertices are not read"),
    "usemap wood\n": ("unread-statement", "`usemap` is not read"),
    "Strange 1 2\n": ("unread-statement", "`strange` is not read"),
}


@pytest.fixture
def findings(tmp_path):
    def validate(obj="", mtl="", whole=False):
        root = write_tiny_dataset(tmp_path / "data")
        folder = root / "object" / TABLE
        before = (folder / f"{TABLE}.obj").read_text()
        (folder / f"{TABLE}.obj").write_text(obj if whole else before + obj)
        (folder / f"{TABLE}.mtl").write_text((folder / f"{TABLE}.mtl").read_text() + mtl)
        rules = {"flat-model", "bridged-face", "bent-face", "unread-statement", "unreadable"}
        rules |= {"ambiguous-opacity", "clamped-value"}
        found = [f for f in validate_house(open_dataset(root), HOUSE_ID) if f.rule in rules]
        return [(f.rule, f.element, f.message, f.file) for f in found], before.count("\n")

    return validate


def test_good_files_have_no_finding(findings):
    assert findings()[0] == []


@pytest.mark.parametrize("text", CASES, ids=[rule for rule, _ in CASES.values()])
def test_faces_and_statements(findings, text):
    ((rule, element, message, file),), before = findings(text)
    expected, words = CASES[text]
    assert (rule, element) == (expected, f"line {before + text.count(chr(10))}")
    assert message.startswith(words)
    assert file.endswith(f"{TABLE}.obj")


FACE = "v 2 2 0\nv 6 2 0\nv 6 5 0\nv 2 5 0\n"


@pytest.mark.parametrize(
    "face",
    ["-4 -3 -2 -1 -4", "-4 -4 -3 -2 -1", "-4 -4 -3 -2 -1 -4", "-4 -3 -3 -3 -2 -1", "-4 -3 -2 -1 -1 -4 -4",
     "-4 -3 -2 -2 -1 -1", "-4 -3 -2 -2"],
)  # fmt: skip
def test_corners_repeated_at_once_are_no_bridge(findings, face):
    assert findings(f"{FACE}f {face}\n")[0] == []


def test_a_bridge_with_corners_repeated_at_once(findings):
    ((rule, *_),), _ = findings(f"{FRAME}f -8 -8 -7 -6 -5 -8 -8 -4 -3 -3 -2 -1 -4 -4\n")
    assert rule == "bridged-face"


def test_a_folded_face_is_reported_with_its_line(findings):
    folded = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 1 .1 .05\nv 0 .1 .05\nv 0 1 0\nf -6 -5 -4 -3 -2 -1\n"
    ((rule, element, *_),), before = findings(folded)
    assert (rule, element) == ("bent-face", f"line {before + 7}")


def test_statements_of_a_library(findings):
    ((rule, _, message, file),), _ = findings(mtl="map_d leaf.png\nNi 1.5\nPr 0.2\n")
    assert (rule, message, file.endswith(f"{TABLE}.mtl")) == ("unread-statement", "`map_d` is not read", True)


@pytest.mark.parametrize(
    ("maps", "is_read"),
    [("map_Kd a.png\nmap_d a.png", True), ("map_d tex\\A.png\nmap_Kd -s 2 2 ../tex/a.png # oak", True),
     ("map_d -imfchan m a.png\nmap_Kd a.png", True), ("map_Kd a.png\nmap_d b.png", False), ("map_d", False),
     ("map_Kd a.png\nnewmtl y\nmap_d a.png", False)],
)  # fmt: skip
def test_an_opacity_map_of_the_colour_map(maps, is_read):
    found = _unread_statements(f"newmtl x\n{maps}\n")
    assert list(found) == ([] if is_read else ["map_d"])


@pytest.mark.parametrize(
    ("line", "keyword"),
    [("Kd 1.2 0 0", "Kd"), ("Kd 0 0 -0.1", "Kd"), ("Ks 0 2 0", "Ks"), ("d 1.5", "d"), ("d -halo 3", "d"),
     ("Tr -1\nd 1", "Tr"), ("Ns 2000", "Ns"), ("Kd 1 1 1", None), ("Kd 0 0 0 7", None), ("Ns 1000", None)],
)  # fmt: skip
def test_values_outside_of_their_range(findings, line, keyword):
    found, _ = findings(mtl=f"newmtl x\n{line}\n")
    message = f"`{keyword}` is outside of its range: it is clamped"
    assert [(rule, words) for rule, _, words, _ in found] == ([] if keyword is None else [("clamped-value", message)])


@pytest.mark.parametrize(
    ("mtl", "words"),
    [("newmtl x\nTr 1.000000\nillum 2\n", "`Tr 1` without `d` is read as opaque"), ("newmtl x\nTr 1\nd 1\n", None),
     ("newmtl x\nd 1\nTr 1\n", None), ("newmtl x\nTr 0.3\nnewmtl y\nd 1\n", None)],
)  # fmt: skip
def test_an_ambiguous_opacity(findings, mtl, words):
    found = [(rule, message) for rule, _, message, _ in findings(mtl=mtl)[0]]
    assert found == ([] if words is None else [("ambiguous-opacity", words)])


def test_an_opacity_of_meshlab():
    header = "# Wavefront material file\n# Converted by Meshlab Group\n"
    mtl = f"{header}newmtl x\nTr 0.3\n"
    assert [line for line, _ in _ambiguous_opacities(mtl)] == [4]
    assert list(_ambiguous_opacities(mtl + "d 0.7\n")) == []


def test_a_model_without_thickness(findings):
    ((rule, _, message, _),), _ = findings(SHEET, whole=True)
    assert (rule, message.startswith("it has no thickness")) == ("flat-model", True)


def test_a_face_that_crosses_itself(findings):
    ((rule, element, message, _),), before = findings("v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1 0\nf -4 -3 -2 -1\n")
    assert (rule, element) == ("unreadable", f"line {before + 5}")
    assert "crosses itself" in message
