"""Scenes of random triangles by hand, and a brute-force caster in float64 that knows nothing of trees."""

import functools
import os
from dataclasses import dataclass, field
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import shoebox

from home_mjx.bank.bank import HouseBank
from home_mjx.bank.records import Geometry
from home_mjx.bank.records.geometry import CUTOUT_SHIFT
from home_mjx.geometry.bvh import build_tree, build_triangle_tree
from home_mjx.raycast_render.scene.types import DynamicInstances, Scene

# `JAX_PLATFORMS=cuda,cpu python -m pytest tests/raycast_render` includes the GPU.
needs_gpu = pytest.mark.skipif(
    "cuda" not in os.environ.get("JAX_PLATFORMS", ""), reason="needs an NVIDIA GPU: JAX_PLATFORMS=cuda,cpu"
)
CUDA = pytest.param("cuda", marks=needs_gpu)
BACKENDS = ("xla", "cpu", CUDA)


@dataclass
class Placed:
    """A model placed in the world."""

    model: int
    pose: np.ndarray
    object_id: int
    material: int = 0
    moves: bool = False


@dataclass
class Soup:
    """Models, where they stand, and what their materials stop."""

    models: list[np.ndarray]
    placed: list[Placed]
    slots: list[np.ndarray] = field(default_factory=list)
    material_mask: np.ndarray = field(default_factory=lambda: np.full(8, 7))
    uvs: list[np.ndarray] = field(default_factory=list)
    cutout: np.ndarray = field(default_factory=lambda: np.zeros((1, 1, 1), np.uint32))

    def __post_init__(self):
        trees = [build_triangle_tree(m) for m in self.models]
        self.order = [order for _, order in trees]
        self.trees = [tree for tree, _ in trees]
        self.first = np.cumsum([0, *(len(m) for m in self.models)])
        self.slots = self.slots or [np.zeros(len(m), int) for m in self.models]
        self.uvs = self.uvs or [np.zeros((len(m), 3, 2)) for m in self.models]

    def world_triangles(self):
        """Float64 triangles of everything, and their instance, absolute triangle index, object id and mask."""
        parts = []
        for number, p in enumerate(self.placed):
            order = self.order[p.model]
            corners = self.models[p.model][order].astype(np.float32).astype(float)
            pose = p.pose.astype(np.float32).astype(float)
            world = corners @ pose[:, :3].T + pose[:, 3]
            index = self.first[p.model] + np.arange(len(order))
            mask = self.material_mask[p.material + self.slots[p.model][order]]
            parts.append((world, np.full(len(order), number), index, np.full(len(order), p.object_id), mask))
        return [np.concatenate(x) for x in zip(*parts, strict=True)]

    def scene(self):
        """The scene; moving instances keep their number, as a house's movable objects do."""
        static = [i for i, p in enumerate(self.placed) if not p.moves]
        moving = [i for i, p in enumerate(self.placed) if p.moves]
        top, order = build_tree(np.array([self._box(i) for i in static]).reshape(-1, 2, 3), leaf_size=3)
        # Leaves hold runs of instances, so the static ones come first and in tree order.
        self.placed = [self.placed[static[i]] for i in order] + [self.placed[i] for i in moving]
        boxes, children, roots, node = [], [], [], 0
        for tree, first in [*zip(self.trees, self.first, strict=False), (top, 0)]:
            child = tree.child.astype(int)
            leaf = np.where(child == -1, -1, ~(~child + (first << 4)))
            children.append(np.where(child >= 0, child + node, leaf))
            boxes.append(tree.box)
            roots.append(node)
            node += len(child)
        pose = np.array([p.pose for p in self.placed])
        columns = {
            name: np.array([getattr(p, name) for p in self.placed]) for name in ("model", "object_id", "material")
        }
        triangles = np.concatenate([m[o] for m, o in zip(self.models, self.order, strict=True)])
        slot = np.concatenate([s[o] for s, o in zip(self.slots, self.order, strict=True)])
        geometry = Geometry(
            node_box=f32(np.concatenate(boxes)),
            node_child=i32(np.concatenate(children)),
            triangle=f32(triangles),
            triangle_uv=f32(np.concatenate([x[o] for x, o in zip(self.uvs, self.order, strict=True)])),
            triangle_slot=i32(slot),
            triangle_part=i32(np.zeros(len(triangles))),
            model_root=i32(roots[:-1]),
            model_triangle=i32(np.cumsum([0, *map(len, self.models[:-1])])),
            model_box=f32([[m.min(axis=(0, 1)), m.max(axis=(0, 1))] for m in self.models]),
            house_root=i32(roots[-1:]),
            instance_model=i32(columns["model"][None]),
            instance_pose=f32(pose[None]),
            instance_inverse=f32([[invert(p) for p in pose]]),
            instance_object=i32(columns["object_id"][None]),
            instance_material=i32(columns["material"][None]),
            instance_semantic=i32(np.zeros((1, len(pose)))),
            instance_body=i32(np.full((1, len(pose)), -1)),
            object_semantic=i32(np.full((1, len(pose)), -1)),
            material_mask=i32(self.material_mask),
            cutout=jnp.asarray(self.cutout),
            agent_model=i32(0),
            agent_material=i32(0),
            agent_semantic=i32(0),
        )
        bank = _any_bank().replace(geometry=geometry)
        return Scene(bank=bank, house=i32(0), moving=self._moving(len(static)))

    def _moving(self, start):
        rows = [*range(start, len(self.placed)), -1]  # the last slot is unused
        placed = [self.placed[i] for i in rows[:-1]] + [Placed(0, np.eye(3, 4), -1)]
        box = np.array([self._box(i) for i in rows[:-1]] + [[[np.inf] * 3, [-np.inf] * 3]])
        return DynamicInstances(
            instance=i32(rows),
            model=i32([p.model for p in placed]),
            pose=f32([p.pose for p in placed]),
            inverse=f32([invert(p.pose) for p in placed]),
            box=f32(box),
            object_id=i32([p.object_id for p in placed]),
            material=i32([p.material for p in placed]),
            semantic=i32([0] * len(placed)),
        )

    def _box(self, index):
        p = self.placed[index]
        world = self.models[p.model].reshape(-1, 3) @ p.pose[:, :3].T + p.pose[:, 3]
        return np.array([world.min(axis=0) - 1e-4, world.max(axis=0) + 1e-4])


@functools.cache
def _any_bank():
    """For all that rays do not need."""
    return HouseBank.from_compiled([shoebox()])


def f32(x):
    return jnp.asarray(np.asarray(x, np.float32))


def i32(x):
    return jnp.asarray(np.asarray(x, np.int32))


def invert(pose):
    linear = np.linalg.inv(pose[:, :3])
    return np.concatenate([linear, -linear @ pose[:, 3:]], axis=1)


def random_pose(rng, mirrored=False, scale=1.0):
    q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    if (np.linalg.det(q) < 0) != mirrored:
        q[:, 0] *= -1
    return np.concatenate([q * scale, rng.uniform(-3, 3, size=(3, 1))], axis=1)


def random_triangles(rng, n, size=0.6):
    return (rng.uniform(-1, 1, size=(n, 1, 3)) + rng.normal(size=(n, 3, 3)) * size / 2).astype(np.float32)


def random_soup(rng):
    """Turned, mirrored, scaled and sheared instances, three of them moving; object ids as in a house."""
    models = [random_triangles(rng, n) for n in (60, 5, 200, 1)]
    shear = random_pose(rng)
    shear[0, 1] += 0.7
    poses = [
        np.eye(3, 4),
        random_pose(rng),
        random_pose(rng, mirrored=True),
        random_pose(rng, scale=np.array([0.3, 2.0, 1.2])),
        shear,
        random_pose(rng, scale=0.05),
        random_pose(rng),
        random_pose(rng, mirrored=True, scale=1.5),
        random_pose(rng, scale=np.array([1.0, 0.4, 1.0])),
    ]
    kinds = [2, 0, 2, 1, 0, 2, 0, 2, 3]
    placed = [Placed(m, p, i - 1, i % 3, moves=i >= 6) for i, (m, p) in enumerate(zip(kinds, poses, strict=True))]
    slots = [rng.integers(0, 4, len(m)) for m in models]
    return Soup(models, placed, slots, np.array([7, 6, 1, 5, 4, 3, 2, 7]))


def random_cut_outs(rng, edge=40):
    """The same with cut-outs in most materials: random texels of two layers, and texture coordinates beyond 0..1."""
    soup = random_soup(rng)
    holes = rng.random((2, edge, edge)) < 0.5
    padded = np.pad(holes, ((0, 0), (0, 0), (0, -edge % 32)))
    soup.cutout = np.packbits(padded, axis=-1, bitorder="little").view("<u4")
    soup.material_mask = soup.material_mask | np.array([1, 2, 0, 1, 2, 2, 0, 1]) << CUTOUT_SHIFT
    soup.uvs = [rng.uniform(-2, 3, (len(m), 3, 2)).astype(np.float32) for m in soup.models]
    return soup, holes


def random_rays(rng, n):
    origin = rng.uniform(-4, 4, size=(n, 3)).astype(np.float32)
    direction = (rng.uniform(-3, 3, size=(n, 3)) - origin).astype(np.float32)
    return origin, direction


class Truth(NamedTuple):
    """Hits of every ray (rows) with every triangle (columns), in float64."""

    t: np.ndarray  # infinity for none
    u: np.ndarray
    v: np.ndarray
    front: np.ndarray  # in the world
    doubtful: np.ndarray  # (rays,): passes an edge, or ends on a triangle, within float32's rounding


def brute_force(soup, origin, direction, t_min=0.0, t_max=np.inf, exclude=-1, mask=7):
    """Möller and Trumbore's test of every triangle."""
    world, _, _, object_id, stops = soup.world_triangles()
    o, d = origin.astype(float)[:, None], direction.astype(float)[:, None]
    edge_1, edge_2 = (world[:, 1] - world[:, 0])[None], (world[:, 2] - world[:, 0])[None]
    p = np.cross(d, edge_2)
    det = np.sum(p * edge_1, axis=-1)
    s = o - world[None, :, 0]
    u = np.sum(s * p, axis=-1) / det
    q = np.cross(s, edge_1)
    v = np.sum(d * q, axis=-1) / det
    t = np.sum(edge_2 * q, axis=-1) / det
    margin = np.minimum(np.minimum(u, v), 1 - u - v)
    t_min, t_max, exclude, mask = (np.broadcast_to(x, len(o))[:, None] for x in (t_min, t_max, exclude, mask))
    allowed = (stops & mask != 0) & ((object_id != exclude) | (exclude < 0))
    meets = allowed & (margin >= 0) & (t >= t_min) & (t <= t_max)
    ends = (abs(t - t_min) < 1e-4) | (abs(t - np.minimum(t_max, 1e9)) < 1e-4)
    doubtful = allowed & ((abs(margin) < 1e-4) | ((margin > -1e-4) & ends))
    return Truth(np.where(meets, t, np.inf), u, v, det > 0, doubtful.any(axis=1))


def in_jit(function, *args, **static):
    """Under jit and under JAX's strictest rules for mixing types and ranks; the `cpu` backend on a CPU."""
    device = jax.devices("cpu")[0] if static.get("backend") == "cpu" else jax.devices()[0]
    args = jax.device_put(args, device)
    with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
        return jax.tree.map(np.asarray, jax.jit(lambda *a: function(*a, **static))(*args))
