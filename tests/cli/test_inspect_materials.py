"""`home-mjx inspect` says how much of a house is of materials that nobody knows."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from generated import generate_flats
from handmade import Furniture, shoebox

from home_mjx.cli import main
from home_mjx.scene_compile.materials.unknown import unknown_material_share


def test_the_share_is_that_of_the_area():
    """A cube of wood in a room of slabs, each a box; of the slabs some kinds are known."""
    house = shoebox((6.0, 5.0, 3.0), furniture=[Furniture((0.0, 0.0), size=(0.5, 0.5, 0.5))])
    slabs = [2 * float(e[0] * e[1] + e[1] * e[2] + e[2] * e[0]) for e in 2 * np.asarray(house.colliders.size[:6])]
    whole = sum(slabs) + 1.5
    for known in ([], [0], [0, 3], range(6)):
        kinds = tuple("wood" if i in known or i == 6 else "" for i in range(7))
        found = unknown_material_share(replace(house, materials=replace(house.materials, kind=kinds)))
        assert found == pytest.approx(1 - (1.5 + sum(slabs[i] for i in known)) / whole, abs=1e-5)


def renamed(root: Path) -> None:
    """Textures by numbers alone, as a house from elsewhere may have them."""
    stems = sorted((path.stem for path in (root / "texture").iterdir()), key=len, reverse=True)
    for path in (root / "texture").iterdir():
        path.rename(path.with_stem(f"swatch_{stems.index(path.stem)}"))
    for path in (*root.rglob("*.mtl"), *root.rglob("house.json")):
        text = path.read_text()
        for number, stem in enumerate(stems):
            text = text.replace(f"/{stem}.png", f"/swatch_{number}.png")
            text = text.replace(f'"texture":"{stem}"', f'"texture":"swatch_{number}"')
        path.write_text(text)


def test_a_warning_where_textures_are_unknown(tmp_path: Path, capsys: pytest.CaptureFixture):
    generate_flats(tmp_path, range(1))
    shares = []
    for warned in (False, True):
        assert main(["inspect", "--dataset", str(tmp_path)]) == 0
        lines = [line for line in capsys.readouterr().out.splitlines() if line.startswith("warning: ")]
        assert main(["inspect", "--dataset", str(tmp_path), "--json"]) == 0
        shares.append(json.loads(capsys.readouterr().out)["unknown_material"])
        assert len(lines) == warned
        if warned:
            assert lines[0].startswith(f"warning: {shares[1]:.0%} of the area has a default material")
        renamed(tmp_path)
    assert shares[0] < 0.01
    assert shares[1] > 0.2
