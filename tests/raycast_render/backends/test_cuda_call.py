"""How the `cuda` backend is called and its code kept, seen without a GPU; and on one, if there is one."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import trimesh
from handmade import Furniture, shoebox, two_rooms
from jax.sharding import Mesh, NamedSharding, PartitionSpec
from soup import Placed, Soup, f32, i32, needs_gpu, random_pose, random_rays, random_soup

from home_mjx.bank.bank import HouseBank
from home_mjx.core.native import kernel, nvrtc
from home_mjx.core.native.kernel import PTX_TARGET
from home_mjx.errors import BackendError
from home_mjx.raycast_render.backends import cuda
from home_mjx.raycast_render.casting.cast import cast, cast_multi_hit, occluded
from home_mjx.raycast_render.scene.scene import make_scene
from home_mjx.raycast_render.scene.types import Scene


@pytest.mark.parametrize(
    ("shape", "width", "expected"),
    [
        ((1, 1), 0, (1, 1, 1)),
        ((3, 65), 0, (2, 3, 1)),
        ((4096, 4096), 64, (64, 4096, 1)),
        ((4096, 4096), 0, (64, 4096, 1)),
        ((2, 84 * 84), 84, (116, 2, 1)),  # 11 x 21 tiles
        ((5, 70), 7, (2, 5, 1)),  # rows too short for tiles
        ((5, 70), 20, (2, 5, 1)),  # no whole rows
        ((16384, 128 * 128), 128, (256, 16384, 1)),
        ((100_000, 64), 0, (1, 65535, 2)),
    ],
)
def test_grid_covers_all_rays(shape, width, expected):
    assert cuda.launch_grid(*shape, width) == expected


def pretend(monkeypatch):
    """As if there were a GPU for which the kernels are compiled."""
    monkeypatch.setattr(kernel, "_find_problem", lambda kernel, platform: None)
    monkeypatch.setattr(cuda, "compile_kernels", lambda: "the PTX")


def test_nested_vmap_becomes_one_call(monkeypatch):
    pretend(monkeypatch)
    rng = np.random.default_rng(0)
    scene, (origin, direction) = random_soup(rng).scene(), random_rays(rng, 4 * 32 * 16)
    look = jax.vmap(lambda m, o, d: cast(scene.replace(moving=m), o, d, backend="cuda").t, (None, 0, 0))
    moving = jax.tree.map(lambda x: jnp.stack([x] * 4), scene.moving)
    shaped = [f32(x.reshape(4, 2, 16, 16, 3)) for x in (origin, direction)]
    text = jax.jit(jax.vmap(look)).trace(moving, *shaped).lower(lowering_platforms=("cuda",)).as_text()
    calls = [line for line in text.splitlines() if PTX_TARGET in line]
    assert len(calls) == 1
    for said in ('name = "cast_closest"', 'kernel_data = "the PTX"', "grid_x = 8 : i32", "grid_y = 4 : i32"):
        assert said in calls[0]
    assert "tensor<4x512x3xf32>" in calls[0]


def test_any_hit_is_a_kernel_of_its_own_and_no_rays_are_no_call(monkeypatch):
    pretend(monkeypatch)
    rng = np.random.default_rng(0)
    scene, (origin, direction) = random_soup(rng).scene(), random_rays(rng, 8)
    look = jax.jit(lambda s, o, d: occluded(s, o, d, backend="cuda"))
    text = look.trace(scene, f32(origin), f32(direction)).lower(lowering_platforms=("cuda",)).as_text()
    assert 'name = "cast_any"' in text
    text = look.trace(scene, f32(origin[:0]), f32(direction[:0])).lower(lowering_platforms=("cuda",)).as_text()
    assert PTX_TARGET not in text


def test_hits_one_after_the_other_are_one_call(monkeypatch):
    pretend(monkeypatch)
    rng = np.random.default_rng(0)
    scene, (origin, direction) = random_soup(rng).scene(), random_rays(rng, 4 * 3)
    moving = jax.tree.map(lambda x: jnp.stack([x] * 4), scene.moving)
    through = lambda m, o, d: cast_multi_hit(scene.replace(moving=m), o, d, 16, 1e-4, backend="cuda")  # noqa: E731
    shaped = [f32(x.reshape(4, 3, 3)) for x in (origin, direction)]
    look = jax.jit(jax.vmap(jax.vmap(through, (None, 0, 0))))
    text = look.trace(moving, *shaped).lower(lowering_platforms=("cuda",)).as_text()
    calls = [line for line in text.splitlines() if PTX_TARGET in line]
    assert len(calls) == 1
    for said in ('name = "cast_through"', "grid_x = 1 : i32", "grid_y = 4 : i32", "tensor<4x3x16xf32>"):
        assert said in calls[0]


class FakeLibrary:
    """Counts what is compiled."""

    def __init__(self, monkeypatch, folder):
        self.compiled = 0
        self.version = (13, 0)
        monkeypatch.setenv("HOME_MJX_CACHE", str(folder))
        monkeypatch.setattr(nvrtc, "find_library", lambda: self)
        monkeypatch.setattr(nvrtc, "version", lambda library: library.version)
        monkeypatch.setattr(nvrtc, "_known", lambda library, capability: capability)
        monkeypatch.setattr(nvrtc, "_compile", self.compile)

    def compile(self, library, code, name, target, options):
        self.compiled += 1
        return f"{code.decode()} for {target}"


def test_compiled_kernels_are_kept_until_anything_changes(monkeypatch, tmp_path):
    library, source = FakeLibrary(monkeypatch, tmp_path / "cache"), tmp_path / "k.cu"
    source.write_text("one")
    assert [nvrtc.compile_ptx(source, 90) for _ in range(3)] == ["one for compute_90"] * 3
    assert library.compiled == 1
    nvrtc.compile_ptx(source, 80)
    library.version = (13, 1)
    nvrtc.compile_ptx(source, 90)
    source.write_text("two")
    assert nvrtc.compile_ptx(source, 90) == "two for compute_90"
    assert library.compiled == 4
    for size in (1, 2, 2):
        nvrtc.compile_ptx(source, 90, {"SIZE": size})
    assert library.compiled == 6


@pytest.mark.parametrize("damage", ["cut", "empty", "bytes", "changed"])
def test_a_broken_cache_file_is_made_again(monkeypatch, tmp_path, caplog, damage):
    library, source = FakeLibrary(monkeypatch, tmp_path / "cache"), tmp_path / "k.cu"
    source.write_text("one")
    expected = nvrtc.compile_ptx(source, 90)
    (entry,) = (tmp_path / "cache" / "kernels").iterdir()
    whole = entry.read_bytes()
    spoilt = {"cut": whole[:-3], "empty": b"", "bytes": b"\xff\xfe\x80", "changed": whole.replace(b"one", b"two")}
    entry.write_bytes(spoilt[damage])
    assert nvrtc.compile_ptx(source, 90) == expected
    assert library.compiled == 2
    assert "broken cache entry" in caplog.text
    assert entry.read_bytes() == whole


def test_a_cache_that_cannot_be_written_costs_only_time(monkeypatch, tmp_path, caplog):
    (tmp_path / "file").write_text("")
    FakeLibrary(monkeypatch, tmp_path / "file")
    source = tmp_path / "k.cu"
    source.write_text("one")
    assert nvrtc.compile_ptx(source, 90) == "one for compute_90"
    assert "not cached" in caplog.text


def test_without_nvrtc_it_says_what_to_install(monkeypatch):
    monkeypatch.setattr(nvrtc, "_installed", lambda: iter(()))
    monkeypatch.setattr(nvrtc, "NAMES", ("libnvrtc-that-is-not-there.so",))
    nvrtc.find_library.cache_clear()
    with pytest.raises(BackendError, match="no NVRTC"):
        nvrtc.find_library()
    nvrtc.find_library.cache_clear()


E_, R = 8, 16 * 16


@pytest.fixture(scope="module")
def batch():
    """A bank on the GPU, and houses, moving instances, origins and directions of E_ environments."""
    furniture = [Furniture((1.0, 1.0), mass=5.0), Furniture((-1.0, 1.0), (0.4, 0.8, 1.0))]
    bank = HouseBank.from_compiled([shoebox(furniture=furniture), two_rooms()])
    rng = np.random.default_rng(0)
    house = i32(rng.integers(0, 2, E_))
    agents, upright = f32(rng.uniform((-1, -1, 0), (1, 1, 2), size=(E_, 2, 3))), f32([[1, 0, 0, 0]] * 2)

    def place(house, agents):
        return make_scene(
            bank, house, bank.physics.body_pos[house], bank.physics.body_quat[house], agents, upright
        ).moving

    moving = jax.jit(jax.vmap(place))(house, agents)
    origin = f32(rng.uniform(-1, 1, size=(E_, R, 3)) * [2, 2, 1] + [0, 0, 1.5])
    return bank, (house, moving, origin, f32(rng.normal(size=(E_, R, 3))))


def rows(bank, house, moving, origin, direction, backend=None):
    return cast(Scene(bank, house, moving), origin, direction, backend=backend)


per_env = jax.vmap(rows, (None, 0, 0, 0, 0))


def assert_same(a, b):
    for x, y in zip(jax.tree.leaves(a), jax.tree.leaves(b), strict=True):
        np.testing.assert_array_equal(np.asarray(x).reshape(np.shape(y)), y)


@pytest.fixture(scope="module")
def expected(batch):
    """What the `cpu` backend says."""
    bank, args = batch
    bank, args = jax.device_put((bank, args), jax.devices("cpu")[0])
    look = jax.jit(jax.vmap(lambda *a: rows(*a, backend="cpu"), (None, 0, 0, 0, 0)))
    return jax.tree.map(np.asarray, look(bank, *args))


@needs_gpu
def test_on_a_gpu_it_is_chosen_and_agrees_bit_for_bit(batch, expected):
    bank, args = batch
    assert bank.geometry.gpu is not None
    program = jax.jit(per_env).lower(bank, *args).compile()
    assert PTX_TARGET in program.as_text()
    assert_same(program(bank, *args), expected)
    assert_same(jax.jit(per_env)(bank.replace(geometry=bank.geometry.replace(gpu=None)), *args), expected)


@needs_gpu
def test_images_are_cast_in_tiles_to_the_same_hits(batch, expected):
    bank, (house, moving, origin, direction) = batch
    for height, width in ((16, 16), (8, 32), (32, 8), (64, 4)):
        shaped = [x.reshape(E_, height, width, 3) for x in (origin, direction)]
        assert_same(jax.jit(per_env)(bank, house, moving, *shaped), expected)


@needs_gpu
def test_on_a_gpu_any_nesting_gives_the_same_bits(batch, expected):
    bank, args = batch
    each = jax.vmap(jax.vmap(rows, (None, None, None, 0, 0)), (None, 0, 0, 0, 0))
    assert_same(jax.jit(each)(bank, *args), expected)
    outer = jax.vmap(jax.vmap(rows, (None, 0, 0, 0, 0)), (None, None, None, 1, 1), out_axes=1)
    assert_same(jax.jit(outer)(bank, *args), expected)
    scanned = jax.jit(lambda g, b: jax.lax.scan(lambda c, a: (c, rows(g, *a)), 0, b)[1])
    assert_same(scanned(bank, args), expected)


@needs_gpu
def test_on_gpus_shards_and_maps(batch, expected):
    bank, args = batch
    devices = jax.devices()
    mesh = Mesh(np.array(devices), ("envs",))
    spread, whole = PartitionSpec("envs"), PartitionSpec()
    mapped = jax.jit(jax.shard_map(per_env, mesh=mesh, in_specs=(whole, *[spread] * 4), out_specs=spread))
    assert_same(mapped(bank, *args), expected)
    everywhere, by_env = (NamedSharding(mesh, spec) for spec in (whole, spread))
    placed = jax.device_put(bank, everywhere), *jax.device_put(args, by_env)
    program = jax.jit(per_env).lower(*placed).compile()
    assert not [word for word in ("all-gather", "all-reduce", "all-to-all") if word in program.as_text()]
    assert_same(program(*placed), expected)
    split = jax.tree.map(lambda x: x.reshape(len(devices), -1, *x.shape[1:]), args)
    assert_same(jax.pmap(per_env, in_axes=(None, 0, 0, 0, 0))(bank, *split), expected)


@needs_gpu
def test_on_a_gpu_occlusion_and_gradients(batch, expected):
    bank, (house, moving, origin, direction) = batch
    hidden = jax.vmap(lambda h, m, o, d: occluded(Scene(bank, h, m), o, d, mask=1))
    np.testing.assert_array_equal(jax.jit(hidden)(house, moving, origin, direction), expected.instance >= 0)

    def depths(step):
        t = per_env(bank, house, moving, origin + step * direction, direction).t
        return jnp.sum(jnp.where(jnp.isfinite(expected.t), t, 0))

    np.testing.assert_allclose(jax.jit(jax.grad(depths))(0.0), -np.isfinite(expected.t).sum(), rtol=1e-4)


@needs_gpu
def test_of_ten_million_rays_at_edges_and_corners_none_escapes():
    rng = np.random.default_rng(7)
    mesh = trimesh.creation.icosphere(subdivisions=4)
    pose = random_pose(rng, scale=np.array([0.3, 5.0, 1.0]))
    scene = Soup([mesh.triangles.astype(np.float32)], [Placed(0, pose, 0)]).scene()
    corners = mesh.vertices.astype(np.float32).astype(float)
    edges = corners[mesh.edges_unique]
    look = jax.jit(lambda o, d: cast(scene, o, d, backend="cuda"))
    for _ in range(10):
        share = rng.uniform(size=(1_000_000, 1)) * rng.integers(0, 2, (1_000_000, 1))  # every other one at a corner
        ends = edges[rng.integers(0, len(edges), 1_000_000)]
        targets = ends[:, 0] * share + ends[:, 1] * (1 - share)
        inside = rng.uniform(-0.3, 0.3, size=targets.shape)
        origin, target = (points @ pose[:, :3].T + pose[:, 3] for points in (inside, targets))
        hit = look(f32(origin), f32(target - origin))
        assert bool(jnp.all(hit.instance == 0))
        assert not bool(jnp.any(hit.front)), "a ray got out and met the outside"
        assert float(jnp.abs(hit.t - 1).max()) < 2e-3
