"""Images of hand-made rooms: geometry, meaning and colour of every pixel."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import Furniture, shoebox

from home_mjx.bank.bank import HouseBank
from home_mjx.bank.packing.texture_layers import mip_levels
from home_mjx.errors import ConfigError
from home_mjx.navigation.grid import geodesic_distance, random_position, room_below
from home_mjx.raycast_render.cameras.camera import Camera, Lens, is_valid_camera
from home_mjx.raycast_render.casting.cast import cast
from home_mjx.raycast_render.images.render import KINDS, SEMANTIC_KINDS, render
from home_mjx.raycast_render.lighting import texture
from home_mjx.raycast_render.scene.scene import make_open_scene, make_scene
from home_mjx.schema.semantic import Semantic

SIZE = 32
LEVEL = np.array([0.5**0.5, 0.5**0.5, 0, 0])  # looks along +y
UP = np.array([0.0, 1, 0, 0])  # looks along +z, +y down the image


@pytest.fixture(scope="module")
def bank():
    """6 x 5 x 3 m; a low red cube ahead on the left, a high one ahead on the right."""
    red, blue = (0.9, 0.1, 0.1), (0.1, 0.1, 0.9)
    left = Furniture((-1.5, 1.5), (0.4, 0.4, 0.4), mass=5.0, color=red)
    right = Furniture((1.5, 1.5), (0.4, 0.4, 2.6), category="wardrobe_cabinet", color=blue)
    return HouseBank.from_compiled([shoebox(furniture=(left, right))])


def place(bank, agent=(0.0, -1.0, 0.8), house=0):
    physics, upright = bank.physics, jnp.array([[1.0, 0, 0, 0]])
    return make_scene(bank, jnp.int32(house), physics.body_pos[0], physics.body_quat[0], jnp.array([agent]), upright)


@pytest.fixture(scope="module")
def look(bank):
    """Images under JAX's strictest rules; one compiled program per set of options."""
    programs = {}

    def images(pos=(0.0, -1.0, 1.5), quat=LEVEL, kinds=KINDS, exclude=-1, bank=bank, **options):
        key = kinds, tuple(options.items())
        if key not in programs:
            programs[key] = jax.jit(
                lambda scene, camera, exclude: render(
                    scene, camera, Lens(SIZE, SIZE), kinds=kinds, exclude=exclude, **options
                )
            )
        camera = Camera(jnp.asarray(pos, jnp.float32), jnp.asarray(quat, jnp.float32), jnp.float32(np.pi / 2))
        with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
            out = programs[key](place(bank), camera, jnp.int32(exclude))
        return jax.tree.map(np.asarray, out)

    return images


def agent_id(bank):
    return bank.spec.num_instances


def test_known_things_are_where_they_should_be(bank, look):
    image = look(exclude=agent_id(bank))["instance"]
    rows, columns = np.nonzero(image == 0)
    assert columns.max() < SIZE / 2, "the cube at x < 0 is on the left"
    assert rows.min() > SIZE / 2, "the cube below the eye is in the lower half"
    rows, columns = np.nonzero(image == 1)
    assert columns.min() >= SIZE / 2
    assert rows.min() < SIZE / 2 < rows.max()
    # Front face of the low cube: x -1.7..-1.3 and z 0..0.4 at 2.3 m; pixel (row, column) by similar triangles.
    column = ((-1.5 / 2.3) + 1) / 2 * SIZE
    row = (1 - (0.2 - 1.5) / 2.3) / 2 * SIZE
    assert image[int(row), int(column)] == 0


def test_a_house_that_is_none_is_the_nearest_one_everywhere():
    """A negative index would count from the end, and for rays it does not: an image of two houses."""
    two = HouseBank.from_compiled([shoebox(furniture=[Furniture((0.0, 1.5), mass=2.0)]), shoebox((8.0, 7.0, 2.5))])
    camera = Camera(jnp.array([0.0, -1.0, 1.5]), jnp.asarray(LEVEL, jnp.float32), jnp.float32(np.pi / 2))

    @jax.jit
    def images(number):
        return render(place(two).replace(house=number), camera, Lens(8, 8), kinds=KINDS)

    @jax.jit
    def others(number):
        pos = random_position(two, number, jax.random.key(0))
        hit = cast(place(two, house=number), camera.pos, jnp.array([0.0, 1.0, 0.0]))
        room, ids = room_below(two, number, pos), two.semantics_of(number, jnp.arange(3), Semantic.FINE)
        return pos, geodesic_distance(two, number, None, pos), room, ids, hit.t, make_open_scene(two, number).moving

    for asked, given in ((-1, 0), (-2, 0), (9, 1)):
        for found, expected in ((images(asked), images(given)), (others(asked), others(given))):
            jax.tree.map(np.testing.assert_array_equal, found, expected)


def test_depth_is_planar_and_distance_is_not(bank, look):
    images = look(exclude=agent_id(bank))
    depth, wall = images["depth"][..., 0], images["partition"] == 3
    assert wall.sum() > 100
    np.testing.assert_allclose(depth[wall], 3.5, atol=1e-5)
    at = (np.arange(SIZE) + 0.5) / SIZE * 2 - 1
    length = np.sqrt(1 + at[None] ** 2 + at[:, None] ** 2)
    np.testing.assert_allclose(images["distance"][..., 0], depth * length, rtol=1e-5)


def test_depth_is_clipped_or_infinite_outside(look):
    high = (0.0, 0.0, 10.0)
    clipped = look(high, UP)
    assert (clipped["depth"] == 10).all()
    raw = look(high, UP, kinds=("depth", "distance"), depth_max=None)
    assert np.isinf(raw["depth"]).all()
    assert np.isinf(raw["distance"]).all()
    for kind in ("instance", "material", *SEMANTIC_KINDS):
        assert (clipped[kind] == -1).all(), kind
    assert (clipped["normal"] == 0).all()
    sky = texture.encode_srgb(jnp.array(texture.MISS_COLOR))
    np.testing.assert_array_equal(clipped["rgb"], np.broadcast_to(sky, (SIZE, SIZE, 3)))


def test_shapes_and_types(look):
    images = look()
    assert images.pop("valid").item() is True
    for kind, image in images.items():
        channels = {"rgb": (3,), "albedo": (3,), "normal": (3,), "radiance": (3,), "depth": (1,), "distance": (1,)}.get(
            kind, ()
        )
        dtype = np.uint8 if kind == "rgb" else np.float32 if channels else np.int32
        assert image.shape == (SIZE, SIZE, *channels), kind
        assert image.dtype == dtype, kind


def test_ids_are_those_of_what_was_hit(bank, look):
    images = look((0.0, -2.0, 1.0))
    who = images["instance"]
    assert set(np.unique(who)) == {-1, 0, 1, agent_id(bank)}
    semantics = np.asarray(bank.semantics)
    columns = {"fine": Semantic.FINE, "coarse": Semantic.COARSE, "nyu40": Semantic.NYU40, "room": Semantic.ROOM}
    columns |= {"room_type": Semantic.ROOM_TYPE, "size": Semantic.SIZE, "color": Semantic.COLOR}
    for number in (0, 1):
        row = semantics[semantics[:, Semantic.OBJECT_ID] == number]
        assert len(row) == 1
        for kind, column in columns.items():
            assert set(images[kind][who == number]) <= {row[0, column]}, kind
    for partition in np.unique(images["partition"][images["partition"] >= 0]):
        row = semantics[semantics[:, Semantic.PARTITION] == partition][0]
        assert set(images["nyu40"][images["partition"] == partition]) == {row[Semantic.NYU40]}
    assert (images["level"][who < agent_id(bank)] == 0).all()


def test_an_agent_is_seen_unless_excluded(bank, look):
    behind = (0.0, -2.0, 1.0)
    seen, own = look(behind), look(behind, exclude=agent_id(bank))
    person = seen["instance"] == agent_id(bank)
    assert person.sum() > 20
    agent = np.asarray(bank.semantics)[int(bank.geometry.agent_semantic)]
    assert set(seen["fine"][person]) == {agent[Semantic.FINE]}
    assert not (own["instance"] == agent_id(bank)).any()
    np.testing.assert_array_equal(own["depth"][~person], seen["depth"][~person])
    assert (own["depth"][person] > seen["depth"][person]).all()


def test_normals_face_the_camera(bank, look):
    images = look(exclude=agent_id(bank))
    expected = {3: [0, -1, 0], 4: [0, 0, 1], 5: [0, 0, -1], 0: [1, 0, 0], 1: [-1, 0, 0]}
    for partition, normal in expected.items():
        pixels = images["normal"][images["partition"] == partition]
        assert len(pixels) > 10
        np.testing.assert_allclose(pixels, np.broadcast_to(normal, pixels.shape), atol=1e-6)


def textured(bank, size=4):
    """The bank with a random texture on everything; u and v count 2 m along x and z."""
    rng = np.random.default_rng(0)
    texels = rng.integers(0, 256, size=(2, size, size, 4), dtype=np.uint8)
    levels = np.stack([mip_levels(image) for image in texels])
    corner = np.asarray(bank.geometry.triangle)
    geometry = bank.geometry.replace(triangle_uv=jnp.asarray(corner[..., [0, 2]] / 2))
    rows = bank.materials.texture.shape[0]
    materials = bank.materials.replace(
        textures=jnp.asarray(levels.view(np.uint32)[..., 0]),
        texture=jnp.ones(rows, jnp.int32),
        albedo=jnp.ones((rows, 4)),
    )
    return bank.replace(geometry=geometry, materials=materials), texels


def test_every_pixel_shows_its_texel(bank, look):
    """The wall y = 2.5 seen from 2 m: pixels are 1/8 m apart, texels half a metre wide and repeating every 2 m."""
    other, texels = textured(bank)
    pos = (0.0, 0.5, 1.5)
    images = look(pos, bank=other, kinds=("albedo", "partition", "instance"))
    wall = (images["partition"] == 3) & (images["instance"] == -1)
    at = ((np.arange(SIZE) + 0.5) / SIZE * 2 - 1) * 2
    x, z = np.meshgrid(at, 1.5 - at)
    column, row = np.floor(x / 2 % 1 * 4).astype(int), 3 - np.floor(z / 2 % 1 * 4).astype(int)
    value = texels[1][row, column][..., :3] / 255
    expected = np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)
    assert wall.sum() > 300
    np.testing.assert_allclose(images["albedo"][wall], expected[wall], rtol=1e-5)


def test_srgb_bytes_survive_decoding_and_encoding():
    every = np.repeat(np.arange(256)[:, None], 3, axis=1)
    linear = jnp.asarray(texture.SRGB_TO_LINEAR)[jnp.asarray(every)]
    np.testing.assert_array_equal(texture.encode_srgb(linear), every)


def test_light_falls_with_the_angle_and_colours_stay(bank, look):
    images = look((0.0, 0.0, 1.5))
    wall = images["partition"] == 3
    rgb = images["rgb"].astype(int)
    middle, edge = rgb[SIZE // 2, SIZE // 2], rgb[SIZE // 2][wall[SIZE // 2]][0]
    assert wall[SIZE // 2, SIZE // 2]
    assert (middle > edge).all()
    red = look((-1.5, 0.0, 0.3))
    pixels = red["rgb"][red["instance"] == 0].astype(int)
    assert len(pixels) > 10
    assert (pixels[:, 0] > 4 * pixels[:, 1]).all()


def test_only_what_is_asked_for_is_computed(bank):
    camera = Camera(jnp.zeros(3), jnp.asarray(LEVEL, jnp.float32), jnp.float32(1.0))

    def uses_textures(kinds):
        program = jax.make_jaxpr(lambda s, c: render(s, c, Lens(4, 4), kinds=kinds))
        return any("u8[" in str(eqn) for eqn in program(place(bank), camera).eqns)

    assert uses_textures(("depth", "rgb"))
    assert not uses_textures(("depth", "normal", "fine"))
    camera_ids = jax.jit(lambda s, c: render(s, c, Lens(4, 4), kinds=("fine",)))(place(bank), camera)
    assert list(camera_ids) == ["fine"]


def test_unknown_kind_is_refused_with_a_hint(bank):
    camera = Camera(jnp.zeros(3), jnp.asarray(LEVEL, jnp.float32), jnp.float32(1.0))
    with pytest.raises(ConfigError, match="Did you mean `depth`"):
        render(place(bank), camera, kinds=("deptth",))


@pytest.mark.parametrize(
    "change", [{"quat": 1.05 * LEVEL}, {"quat": 0 * LEVEL}, {"fovy": 90.0}, {"fovy": -1.0}], ids=str
)
def test_cameras_that_cannot_be_are_refused_and_inside_jit_flagged(bank, look, change):
    quat, fovy = change.get("quat", LEVEL), change.get("fovy", 1.0)
    camera = Camera(jnp.zeros(3), jnp.asarray(quat, jnp.float32), jnp.float32(fovy))
    with pytest.raises(ConfigError, match=r"unit length, got|field of view \[rad\] between 0 and pi, got"):
        render(place(bank), camera)
    assert not is_valid_camera(camera, Lens())
    if "quat" in change:
        images = look(quat=quat)
        assert not images["valid"]
        assert (images["instance"] == -1).all()
    else:
        assert is_valid_camera(camera, Lens(model="panorama")), "it has no field of view"
