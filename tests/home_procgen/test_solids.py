"""Solids, panels with holes, base textures and outlines of rooms."""

import numpy as np
import pytest
import trimesh

from home_mjx.geometry.wall_prisms import extrude_grid
from home_mjx.schema.categories import texture_family
from home_mjx.schema.material_kinds import TEXTURE_KINDS
from home_procgen.floor_plan.rooms import PlanWall, Rect, RoomPlan, outer_spans, outline, shared_span
from home_procgen.primitives.solids import box, cushion, cylinder, lathe, project_uv, rotate
from home_procgen.primitives.textures import BASE_RECIPES, base_texture


def as_trimesh(mesh):
    return trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)


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


def test_outline_of_an_l():
    polygon = outline([Rect(0.0, 0.0, 4.0, 5.0), Rect(4.0, 0.0, 6.0, 2.0)])
    assert polygon.tolist() == [[0, 0], [6, 0], [6, 2], [4, 2], [4, 5], [0, 5]]


def test_spans_of_walls():
    one = RoomPlan("Room", (Rect(0.0, 0.0, 4.0, 3.0),))
    two = RoomPlan("Room", (Rect(1.0, 3.0, 2.5, 5.0),))
    bottom = next(wall for wall in one.walls if wall.line == 3.0 and wall.axis == 0)
    assert outer_spans(bottom, two.walls) == [(0.0, 1.0), (2.5, 4.0)]
    assert [span for wall in two.walls if (span := shared_span(bottom, wall))] == [(1.0, 2.5)]
    assert outer_spans(PlanWall((0.0, 0.0), (4.0, 0.0)), two.walls) == [(0.0, 4.0)]
