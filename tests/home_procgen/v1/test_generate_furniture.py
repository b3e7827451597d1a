"""The model library: closed solids, plausible sizes, categories that exist, textures of known families."""

import numpy as np
import pytest
import trimesh

from home_mjx.geometry.wall_prisms import extrude_grid
from home_mjx.schema.categories import COARSE, FINE, NYU40, texture_family
from home_mjx.schema.material_kinds import TEXTURE_KINDS
from home_procgen.primitives.categories import CATEGORIES
from home_procgen.primitives.palette import FINISHES
from home_procgen.primitives.solids import box, cushion, cylinder, lathe, project_uv, rotate
from home_procgen.primitives.textures import BASE_RECIPES, base_texture
from home_procgen.v1.furniture import family_models, library

# Medians of SUNCG per fine class (width, height, depth in m), from the format's reference.
SUNCG_SIZES = {
    "wardrobe_cabinet": (0.84, 2.00, 0.47),
    "chair": (0.53, 0.86, 0.58),
    "sofa": (2.15, 0.88, 1.05),
    "coffee_table": (0.95, 0.49, 0.61),
    "desk": (1.30, 0.75, 0.70),
    "stand": (0.48, 0.60, 0.46),
    "armchair": (0.76, 0.85, 0.84),
    "tv_stand": (1.50, 0.64, 0.46),
    "dining_table": (1.40, 0.74, 0.90),
    "dresser": (1.20, 0.90, 0.49),
    "double_bed": (1.83, 1.00, 2.17),
    "office_chair": (0.66, 1.06, 0.65),
    "floor_lamp": (0.35, 1.58, 0.46),
    "table_lamp": (0.24, 0.50, 0.34),
    "bathtub": (1.79, 0.79, 1.30),
    "television": (1.06, 0.70, 0.10),
}


def as_trimesh(mesh):
    return trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)


def test_there_is_much_to_choose_from():
    assert len(library()) >= 80
    assert len(family_models()) >= 40
    assert len({model.fine for model in library().values()}) >= 30


def test_models_are_closed_and_outward():
    for model in library().values():
        for mesh in (as_trimesh(mesh) for mesh in (model.mesh, model.closed) if mesh):
            assert mesh.is_watertight, model.id
            assert mesh.is_winding_consistent, model.id
            assert all(part.volume > 0 for part in mesh.split(only_watertight=False)), model.id
            assert mesh.area_faces.min() > 1e-8, model.id


def test_origin_is_at_the_bottom_centre():
    for model in library().values():
        low, high = model.box
        assert low[1] == pytest.approx(0, abs=1e-6), model.id
        if model.fine not in ("door", "window"):
            np.testing.assert_allclose((low + high)[[0, 2]], 0, atol=1e-5, err_msg=model.id)


def test_sizes_are_near_those_of_suncg():
    for fine, expected in SUNCG_SIZES.items():
        sizes = [m.size for m in library().values() if m.fine == fine]
        middle = np.median(sizes, axis=0)
        assert (np.abs(np.log(middle[:2] / expected[:2])) < np.log(1.55)).all(), (fine, middle)


def test_categories_are_those_of_suncg():
    for name, category in CATEGORIES.items():
        assert name in FINE
        assert category.coarse in COARSE
        assert category.nyu40 in NYU40
    assert {model.fine for model in library().values()} <= set(CATEGORIES)


def test_slots_have_finishes_and_every_slot_is_used():
    for model in library().values():
        assert set(model.slots.values()) <= set(FINISHES), model.id
        assert len(model.mesh.materials) == len(model.slots) == len(np.unique(model.mesh.slot)), model.id


def test_chairs_fit_under_dining_tables():
    """Legs at the corners only: the space below the middle of the top is empty up to a chair's seat."""
    for model in family_models()["dining_table"]:
        wide, _, deep = model.size
        under = np.array([[-0.3 * wide, 0.01, -0.5 * deep], [0.3 * wide, 0.5, 0.5 * deep]])
        overlap = np.minimum(model.parts[:, 1], under[1]) - np.maximum(model.parts[:, 0], under[0])
        assert not (overlap.min(-1) > 0).any()


def test_an_open_door_can_be_walked_through_and_a_closed_one_cannot():
    for model in family_models()["door"]:
        point = np.array([[x, y, -1.5] for x in np.linspace(-0.3, 0.3, 7) for y in (0.3, 1.0, 1.9)])
        forward = np.tile([0.0, 0.0, 1.0], (len(point), 1))
        hits = [as_trimesh(mesh).ray.intersects_any(point, forward) for mesh in (model.mesh, model.closed)]
        assert not hits[0].any()
        assert hits[1].all()


def test_a_door_turns_rigidly_about_its_hinge():
    """Frame vertices stay, leaf vertices keep their distance from the vertical hinge line."""
    for model in family_models()["door"]:
        opened, closed = model.mesh.vertices, model.closed.vertices
        assert (model.mesh.faces == model.closed.faces).all()
        moved = np.abs(opened - closed).max(-1) > 1e-6
        assert 0 < moved.sum() < len(moved)
        hinge = np.array([0.05 - model.size[0] / 2, -0.07])
        radii = [np.hypot(*(v[moved][:, [0, 2]] - hinge).T) for v in (opened, closed)]
        np.testing.assert_allclose(*radii, atol=1e-5)
        np.testing.assert_allclose(opened[:, 1], closed[:, 1])


def test_lamps_have_lights_inside_their_boxes():
    lit = [model for model in library().values() if model.lights]
    assert {"chandelier", "floor_lamp", "table_lamp"} == {model.fine for model in lit}
    for model in lit:
        low, high = model.box + np.array([[-0.05], [0.05]])
        assert all((low < light.position).all() and (light.position < high).all() for light in model.lights)
        assert all(5 <= light.power <= 60 for light in model.lights)


def test_windows_have_glass():
    for model in family_models()["window"]:
        glass = [m for name, m in zip(model.slots, model.mesh.materials, strict=True) if name == "color_1"]
        assert glass[0].opacity < 1


def test_uvs_are_in_metres():
    """Equal areas on the surface and in the texture, on every face along an axis."""
    solid = box("wood", (1.0, 0.5, 2.0))
    edges = solid.uv[:, 1:] - solid.uv[:, :1]
    uv_area = np.abs(np.linalg.det(edges)) / 2
    corners = solid.vertices[solid.faces]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=-1) / 2
    np.testing.assert_allclose(uv_area, area, atol=1e-12)


def test_grain_runs_along_the_longer_way():
    for size in ((0.1, 2.0, 0.1), (2.0, 0.1, 0.1), (0.1, 0.1, 2.0)):
        solid = box("wood", size)
        extent = np.ptp(project_uv(solid.vertices, solid.faces), axis=1)
        assert sorted(extent[:, 0].round(9)) == [0.1] * 4 + [2.0] * 8


@pytest.mark.parametrize(
    ("solid", "volume"),
    [
        (box("wood", (1.0, 2.0, 3.0), (4.0, 5.0, 6.0)), 6.0),
        (cylinder("wood", 0.5, 2.0, sides=400), np.pi / 4 * 2.0),
        (cylinder("wood", 1.0, 3.0, top=0.0, sides=400), np.pi),
        (lathe("wood", [(1.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0)], sides=400, closed=True), 3 * np.pi),
        (rotate(box("wood", (1.0, 2.0, 3.0)), 1, 0.7, (1.0, 0.0, 0.0)), 6.0),
        # a cube less a bevel of b: edges lose b^2/2 per length, corners overlap
        (cushion("wood", (1.0, 1.0, 1.0), bevel=0.1), 1 - 12 * 0.005 * 0.8 - 8 * 5 * 0.001 / 6),
    ],
)
def test_volumes_of_solids(solid, volume):
    mesh = as_trimesh(solid)
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(volume, rel=1e-4)


def test_a_panel_with_holes_is_watertight_and_has_their_number_of_handles(rng):
    us, vs = (np.sort(rng.uniform(0, 5, 7)) for _ in range(2))
    keep = np.ones((6, 6), bool)
    keep[1, 1] = keep[3, 2:4] = keep[4, 4] = False  # (3, 3) and (4, 4) touch at a corner only
    keep[4, 4] = True
    points, faces, large = extrude_grid(us, vs, keep, (0.0, 0.1))
    mesh = trimesh.Trimesh(points, faces, process=False)
    area = (np.diff(us)[:, None] * np.diff(vs) * keep).sum()
    assert mesh.is_watertight
    assert mesh.euler_number == 2 - 2 * 2
    assert mesh.volume == pytest.approx(0.1 * area)
    assert mesh.area_faces[large].sum() == pytest.approx(2 * area)


def test_textures_are_of_known_families_and_seamless():
    for name in BASE_RECIPES:
        image = base_texture(name).astype(float)
        assert image.shape == (128, 128, 3)
        if texture_family(name) == "picture":
            continue
        assert texture_family(name) in TEXTURE_KINDS, name
        inner = np.abs(np.diff(image, axis=1)).mean((0, 2))
        seam = np.abs(image[:, 0] - image[:, -1]).mean()
        assert seam <= inner.max() + 1, name
