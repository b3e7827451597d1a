"""Textures of Box nodes: the whole image on each face, upright on walls."""

import numpy as np

from home_mjx.scene_compile.objects.placed_objects import unit_cube


def test_textures_stand_upright_on_walls_and_are_not_mirrored():
    cube = unit_cube()
    walls = 0
    for triangle, uv in zip(cube.triangle.astype(float), cube.uv.astype(float), strict=True):
        assert set(np.unique(uv)) <= {0.0, 1.0}
        normal = np.cross(triangle[1] - triangle[0], triangle[2] - triangle[0])
        edges, steps = triangle[1:] - triangle[0], uv[1:] - uv[0]
        along_u, along_v = np.linalg.solve(steps, edges)  # in the world, of one unit of u and of v
        np.testing.assert_allclose(np.cross(along_u, along_v), normal, atol=1e-9)
        if abs(normal[2]) < 0.5:
            walls += 1
            np.testing.assert_allclose(along_v, [0.0, 0.0, 1.0], atol=1e-9)
    assert walls == 8
