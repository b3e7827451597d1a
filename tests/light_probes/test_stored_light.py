"""Records of light on disk: found again on other machines, and made by several processes with the same bits."""

from dataclasses import fields, replace

import numpy as np
import pytest
from handmade import shoebox
from PIL import Image
from test_light_bake import FEW, bake, grey

from home_mjx.audio_jax.late_reverb.bake.field_cache import LateReverbBake
from home_mjx.bank.bank import HouseBank
from home_mjx.core import workers
from home_mjx.houses import add_bakes, bakes
from home_mjx.light_probes import LightProbeBake
from home_mjx.light_probes.field import stack_fields
from home_mjx.scene_compile.materials.surface import maps_table
from home_mjx.schema.lighting import SurfaceMaps


@pytest.fixture(autouse=True)
def own_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path / "cache"))


def textured(house, path):
    return replace(house, materials=replace(house.materials, texture=(str(path),) * len(house.materials.mask)))


def test_a_record_is_found_where_textures_are_encoded_otherwise_and_drawn_a_step_apart(tmp_path):
    """Another folder, another compression, single texels one step off: one entry; other colours or holes: others."""
    pixels = np.random.default_rng(0).integers(40, 200, (64, 64, 4), dtype=np.uint8)
    pixels[..., 3] = 255
    near, dark, holed = pixels.copy(), pixels // 2 + [0, 0, 0, 128], pixels.copy()
    near[3, 5:8, 1] += 1
    holed[:32, :, 3] = 0
    shown = {"first": pixels, "again": near, "dark": dark.astype(np.uint8), "holed": holed}
    for level, (name, image) in enumerate(shown.items()):
        Image.fromarray(image).save(tmp_path / f"{name}.png", compress_level=level)
    house = grey(shoebox(), 0.6)
    entries = {name: bakes.bake_entry(LightProbeBake(), textured(house, tmp_path / f"{name}.png")) for name in shown}
    assert entries["first"] == entries["again"]
    assert len(set(entries.values())) == 3


def test_a_record_is_found_by_another_machine_that_draws_the_textures_of_the_cache(tmp_path, monkeypatch):
    """Textures drawn by one version have one path in the cache folder, whatever their last digits."""
    found = []
    for level, name in ((40, "generated-v5"), (43, "generated-v5"), (40, "generated-v6")):
        monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path / str(len(found))))
        path = tmp_path / str(len(found)) / name / "texture" / "wood.png"
        path.parent.mkdir(parents=True)
        Image.fromarray(np.full((8, 8, 4), level, np.uint8)).save(path)
        found.append(bakes.bake_entry(LightProbeBake(), textured(grey(shoebox(), 0.6), path)).name)
    assert found[0] == found[1]
    assert found[0] != found[2]


def test_houses_are_baked_in_processes_with_the_same_bits(monkeypatch):
    """Each process has a bank of its own and stores its record; a later call only reads."""
    monkeypatch.setattr(workers, "usable_cores", lambda: 2)
    houses = [
        replace(grey(shoebox(size), 0.6, {"pos": (1.0, 0.0, 2.0)}), id=f"house{i}")
        for i, size in enumerate([(6.0, 5.0, 3.0), (4.0, 3.0, 2.5)])
    ]
    kind, bank = LightProbeBake(FEW), HouseBank.from_compiled(houses)
    monkeypatch.setattr(bakes, "_bake_in_threads", lambda *_: pytest.fail("baked in this process"))
    made = add_bakes(bank, houses, kind).bakes["light_probes"]
    whole = stack_fields([bake(house) for house in houses])
    for field in fields(type(whole)):
        assert np.asarray(getattr(made, field.name)).tobytes() == np.asarray(getattr(whole, field.name)).tobytes()
    monkeypatch.setattr(bakes, "_bake_in_processes", lambda *_: pytest.fail("baked again"))
    add_bakes(bank, houses, kind)


@pytest.mark.parametrize("kind", [LightProbeBake, LateReverbBake])
def test_records_do_not_depend_on_maps_that_their_bakes_do_not_read(kind):
    house = grey(shoebox(), 0.6)
    maps = maps_table([SurfaceMaps(emission=(1.0, 2.0, 0.0), metallic=1.0)])
    glowing = replace(house, materials=replace(house.materials, maps=maps))
    assert bakes.bake_entry(kind(), glowing) == bakes.bake_entry(kind(), house)
