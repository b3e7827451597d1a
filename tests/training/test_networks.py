"""Networks: distributions against SciPy, forgetting at episodes' begins, every observation read."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy import stats

pytest.importorskip("flax", reason="needs the extra `train`")

from home_mjx.errors import ConfigError
from home_mjx.schema.categories import COARSE
from home_mjx.schema.semantic import Semantic
from home_mjx.schema.vocabulary import vocabularies
from home_mjx.tasks.base.specs import ArraySpec
from home_mjx.tasks.language.vocabulary import to_word, tokenize
from home_mjx.tasks.rules.enums import Attribute
from home_mjx.training.networks import Categorical, Gaussian, NetworkConfig, RecurrentAgent, make_distribution
from home_mjx.training.networks.encoders import Encoder, encoder_kind, id_codes
from home_mjx.training.networks.goal_mask import id_column, mark_named_pixels, observed_tokens
from home_mjx.training.networks.images import QueryMaps
from home_mjx.training.networks.query_attention import NAMED_LOGIT, NULL_WEIGHT, QueryAttention
from home_mjx.training.networks.sensor_encoders import ScanEncoder, SpectraEncoder, WordEncoder, squash

SPECS = {
    "pixels/head_rgb": ArraySpec((16, 16, 3), "uint8", 0, 255),
    "pixels/head_depth": ArraySpec((16, 16, 1), "float32", 0.0, 10.0),
    "ids/head_fine": ArraySpec((16, 16), "int32", -1, 2**31 - 1),
    "local_map": ArraySpec((8, 8), "uint8", 0, 1),
    "log_mel": ArraySpec((2, 8, 8), "float32"),
    "audio": ArraySpec((2, 160), "float32", -1e6, 1e6),
    "goal": ArraySpec((3,), "float32", (0.0, -1.0, -1.0), (1000.0, 1.0, 1.0)),
    "instruction": ArraySpec((6,), "int32", 0, 32767),
}
SMALL = NetworkConfig(features=16, memory=8, channels=(4, 8))
MOVES = ArraySpec((), "int32", 0, 3)
DRIVE = ArraySpec((2,), "float32", -1.0, 1.0)


def observations(rng: np.random.Generator, steps: int, rows: int, specs: dict[str, ArraySpec] = SPECS) -> dict:
    def draw(spec: ArraySpec) -> jax.Array:
        shape = (steps, rows, *spec.shape)
        if spec.dtype == "float32":
            return jnp.asarray(rng.uniform(0, 1, shape), jnp.float32)
        return jnp.asarray(rng.integers(0, np.max(spec.high), shape, endpoint=True), spec.dtype)

    return {name: draw(spec) for name, spec in specs.items()}


def test_kinds_of_observations():
    kinds = [encoder_kind(name, spec) for name, spec in SPECS.items()]
    assert kinds == ["image", "image", "ids", "image", "spectra", "sound", "vector", "words"]
    assert encoder_kind("camera/head_pose", ArraySpec((4, 4))) == "none"
    assert encoder_kind("previous_reward", ArraySpec(())) == "vector"
    assert encoder_kind("log_mel", ArraySpec((2, 8, 40))) == "spectra"


def test_ears_are_told_apart_however_loud_it_is(rng: np.random.Generator):
    """3 dB between the ears move the features at any level."""
    encoder = SpectraEncoder(16)
    quiet = jnp.asarray(rng.uniform(-60, -50, (1, 2, 8, 40)), jnp.float32)
    net, read = jax.jit(encoder.init)(jax.random.key(0), quiet), jax.jit(encoder.apply)
    louder = quiet.at[:, 0].add(3.0)
    moved = [read(net, level + louder) - read(net, level + quiet) for level in (0.0, 40.0)]
    assert min(float(jnp.linalg.norm(x)) for x in moved) > 0.1
    assert not np.array_equal(read(net, quiet[:, ::-1]), read(net, quiet))


def test_blanks_do_not_drown_words():
    """One other word of four changes the features as much, however many blanks follow."""
    encoder, words = WordEncoder(blank=0), jnp.zeros((2, 32), jnp.int32)
    words = words.at[:, :4].set(jnp.asarray([[5, 6, 7, 8], [5, 6, 7, 9]]))
    net, apply = jax.jit(encoder.init)(jax.random.key(0), words), jax.jit(encoder.apply)
    net["params"]["places"] = jnp.zeros_like(net["params"]["places"])
    read = np.asarray(apply(net, words))
    np.testing.assert_allclose(read, apply(net, jnp.roll(words, 9, axis=-1)), atol=1e-5)
    assert np.linalg.norm(read[0] - read[1]) / np.linalg.norm(read[0]) > 0.3
    assert np.all(np.isfinite(apply(net, words * 0)))


def test_pixels_are_marked_that_words_name(rng: np.random.Generator):
    """Against a loop over pixels and words; early words weigh more, and what has no name is never marked."""
    text = tokenize("find the gray picture_frame and then walk to the table in the kitchen")
    said = jnp.asarray([*text, *[0] * (32 - len(text))])[None]
    for name in ("ids/head_coarse", "ids/head_color", "ids/head_room_type"):
        column = id_column(name)
        names = vocabularies()[column]
        ids = rng.integers(-1, len(names) + 2, (1, 6, 7))
        found = np.asarray(mark_named_pixels(jnp.asarray(ids), column, said))[0]
        for at, number in np.ndenumerate(ids[0]):
            token = tokenize(to_word(names[number]))[0] if 0 <= number < len(names) else None
            told = (1.0, 1 - text.index(token) / 32) if token in text else (0.0, 0.0)
            np.testing.assert_allclose(found[at], told, atol=1e-6)
    assert [id_column(name) for name in ("ids/head_instance", "ids/head_level", "pixels/head_rgb")] == [None] * 3


def test_descriptors_name_what_their_columns_hold():
    """A category in the first columns of `goal_words` marks the same pixels as its name in a sentence."""
    table = COARSE.index("table")
    words = jnp.full((1, len(Attribute)), -1).at[0, Attribute.COARSE].set(table).at[0, Attribute.KIND].set(0)
    ids = jnp.arange(-1, len(COARSE)).reshape(1, 1, -1)
    marked = np.asarray(mark_named_pixels(ids, Semantic.COARSE, observed_tokens("goal_words", words)))[0, 0, :, 0]
    np.testing.assert_array_equal(marked, np.asarray(ids[0, 0]) == table)
    assert observed_tokens("goal_words", words)[0, Attribute.KIND] == -1


def test_a_search_multiplies_each_place_by_a_query(rng: np.random.Generator):
    image, asked = (
        jnp.asarray(rng.normal(size=(2, 4, 5, 6)), jnp.float32),
        jnp.asarray(rng.normal(size=(2, 3)), jnp.float32),
    )
    found, net = QueryMaps(num_maps=2).init_with_output(jax.random.key(0), image, asked)
    layer = net["params"]["Dense_0"]
    query = (asked @ layer["kernel"] + layer["bias"]).reshape(2, 6, 2)
    for place in np.ndindex(2, 4, 5):
        np.testing.assert_allclose(found[place], image[place] @ query[place[0]] / 6**0.5, rtol=1e-4, atol=1e-5)


@pytest.fixture
def glimpse(rng: np.random.Generator):
    """Images of 5 channels, marks of two images of ids, words, and a network that reads the words in one way."""
    x = jnp.asarray(rng.normal(size=(3, 4, 6, 5)), jnp.float32)
    named = rng.random((3, 4, 6, 2)) < (0.0, 0.0), rng.random((3, 4, 6, 2)) < 0.3
    named = np.where(np.arange(3)[:, None, None, None] == 2, *named)  # in the last image nothing
    early = named * rng.uniform(0.5, 1, named.shape)
    marks = jnp.asarray(np.stack([named, early], axis=-1).reshape(3, 4, 6, 4), jnp.float32)
    asked, net = jnp.asarray(rng.normal(size=(3, 7)), jnp.float32), QueryAttention(num_heads=1, features=6)
    return net, jax.jit(net.init)(jax.random.key(0), x, marks, asked), x, marks, asked


def test_a_glimpse_is_a_mean_over_pixels_by_what_names_them(glimpse):
    """As loops over pixels say."""
    net, params, x, marks, asked = glimpse
    query, read = params["params"]["Dense_0"], params["params"]["Dense_1"]
    found = np.asarray(net.apply(params, x, marks, asked))
    for image in range(3):
        ask = np.asarray(asked[image] @ query["kernel"] + query["bias"], np.float64)
        weights, looked = [], []
        for row, column in np.ndindex(4, 6):
            mark = np.asarray(marks[image, row, column], np.float64)
            count = mark[0] + mark[2]
            weights.append(np.exp(mark @ ask + NAMED_LOGIT * count) if count else 0.0)
            place = 2 * column / 5 - 1, 2 * row / 3 - 1
            looked.append([*np.asarray(x[image, row, column]), *place])
        mass, most = sum(weights), max(weights)
        mean = sum(w * np.array(at) for w, at in zip(weights, looked, strict=True)) / (mass + NULL_WEIGHT)
        area = np.log1p(sum(w / (most + NULL_WEIGHT) for w in weights))
        told = np.concatenate([mean, [mass / (mass + NULL_WEIGHT), area]])
        np.testing.assert_allclose(found[image], np.maximum(told @ read["kernel"] + read["bias"], 0), atol=1e-4)


def test_a_glimpse_sees_nothing_that_no_word_names(glimpse):
    net, params, x, marks, asked = glimpse
    apply, named = jax.jit(net.apply), np.asarray(marks[..., 0] + marks[..., 2] > 0)[..., None]
    own, other, more = np.asarray(x), np.where(named, x, 100 + x), np.where(named, 1 + x, x)
    np.testing.assert_array_equal(apply(params, own, marks, asked), apply(params, other, marks, asked))
    changed = np.asarray(apply(params, more, marks, asked)) != apply(params, own, marks, asked)
    assert changed.any(axis=1).tolist() == [True, True, False]
    slopes = jax.jit(jax.grad(lambda p: jnp.sum(net.apply(p, x, marks, asked) ** 2)))(params)
    assert all(np.isfinite(leaf).all() for leaf in jax.tree.leaves(slopes))


def test_what_more_words_name_is_looked_at():
    """One pixel that two words name, among 31 that one of them names."""
    x = jnp.zeros((1, 32, 32, 1)).at[0, 0, 0].set(1.0)
    marks = jnp.zeros((1, 32, 32, 4)).at[..., 0].set(1.0).at[0, 0, 0, 2].set(1.0)
    net, asked = QueryAttention(num_heads=1, features=4), jnp.zeros((1, 2))
    params = jax.jit(net.init)(jax.random.key(0), x, marks, asked)
    params["params"]["Dense_1"] = {"kernel": jnp.zeros((5, 4)).at[0, 0].set(1.0), "bias": jnp.zeros(4)}
    few = jax.jit(net.apply)(params, x, marks.at[0, 1:].set(0.0), asked)[0, 0]
    assert float(few) == pytest.approx(np.exp(NAMED_LOGIT) / (31 + np.exp(NAMED_LOGIT)), rel=0.01)


def test_codes_of_ids_are_all_different():
    codes = id_codes()
    assert len(np.unique(codes[:200], axis=0)) == pytest.approx(200, abs=10)  # of 4096 possible ones
    assert np.array_equal(codes, id_codes())


def test_a_scan_has_no_end(rng: np.random.Generator):
    """Rays turned by four, the product of both strides, give the features of the ring turned by one."""
    x = jnp.asarray(rng.uniform(0, 10, (2, 64)), jnp.float32)
    net = ScanEncoder(features=16 * 64)
    params, apply = jax.jit(net.init)(jax.random.key(0), x), jax.jit(net.apply)
    params["params"]["Dense_0"] = {"kernel": jnp.eye(16 * 64), "bias": jnp.zeros(16 * 64)}
    ring, turned = (apply(params, a).reshape(2, 16, 64) for a in (x, jnp.roll(x, 4, axis=1)))
    np.testing.assert_allclose(turned, jnp.roll(ring, 1, axis=1), atol=1e-5)
    assert float(jnp.max(ring)) > 0


def test_squash_is_odd_and_grows_with_the_logarithm():
    x = jnp.array([-100.0, -1.0, 0.0, 1.0, 100.0])
    np.testing.assert_allclose(squash(x), np.sign(x) * np.log1p(np.abs(x)), rtol=1e-6)


def test_gaussian_is_scipys(rng: np.random.Generator):
    gaussian = make_distribution(DRIVE)
    assert isinstance(gaussian, Gaussian)
    mean, log_scale, action = rng.normal(size=(3, 5, 2)).astype(np.float32) * 0.3
    params = jnp.concatenate([mean, log_scale], axis=-1)
    normal = stats.norm(mean, np.exp(log_scale))
    np.testing.assert_allclose(gaussian.log_prob(params, jnp.asarray(action)), normal.logpdf(action).sum(-1), rtol=1e-5)
    np.testing.assert_allclose(gaussian.entropy(params), normal.entropy().sum(-1), rtol=1e-5)
    drawn = jax.vmap(lambda key: gaussian.sample(params[0], key))(jax.random.split(jax.random.key(0), 4000))
    first = stats.norm(mean[0, 0], np.exp(log_scale[0, 0]))
    assert stats.kstest(np.asarray(drawn[:, 0]), first.cdf).pvalue > 0.01
    assert jnp.array_equal(gaussian.clip(jnp.array([3.0, -0.5])), jnp.array([1.0, -0.5]))


def test_categorical_is_scipys(rng: np.random.Generator):
    both = make_distribution(ArraySpec((2,), "int32", 0, (3, 1)))
    assert both == Categorical((4, 2))
    logits = rng.normal(size=(5, 6)).astype(np.float32)
    first, second = (np.exp(x) / np.exp(x).sum(-1, keepdims=True) for x in (logits[:, :4], logits[:, 4:]))
    action = np.array([[0, 1], [3, 0], [1, 1], [2, 0], [2, 1]])
    rows = np.arange(5)
    wanted = np.log(first[rows, action[:, 0]] * second[rows, action[:, 1]])
    np.testing.assert_allclose(both.log_prob(jnp.asarray(logits), jnp.asarray(action)), wanted, rtol=1e-5)
    entropy = [stats.entropy(a) + stats.entropy(b) for a, b in zip(first, second, strict=True)]
    np.testing.assert_allclose(both.entropy(jnp.asarray(logits)), entropy, rtol=1e-5)
    assert np.array_equal(both.mode(jnp.asarray(logits)), np.stack([first.argmax(-1), second.argmax(-1)], -1))
    drawn = jax.vmap(lambda key: both.sample(jnp.asarray(logits[0]), key))(jax.random.split(jax.random.key(0), 4000))
    counts = np.bincount(np.asarray(drawn[:, 0]) * 2 + np.asarray(drawn[:, 1]), minlength=8)
    wanted = np.outer(first[0], second[0]).ravel().astype(np.float64)
    assert stats.chisquare(counts, counts.sum() * wanted / wanted.sum()).pvalue > 0.01


def test_single_choice_has_no_axis():
    single = make_distribution(MOVES)
    logits = jnp.array([[0.0, 5.0, 0.0, 0.0]])
    assert single.mode(logits).shape == (1,)
    assert single.log_prob(logits, jnp.array([1])).shape == (1,)


def test_unknown_actions_are_refused():
    with pytest.raises(ConfigError, match="no distribution"):
        make_distribution(ArraySpec((2, 2), "float32", -1.0, 1.0))
    with pytest.raises(ConfigError, match="observe nothing"):
        RecurrentAgent.from_specs({"camera/head_pose": ArraySpec((4, 4))}, MOVES)


@pytest.mark.parametrize("action", [MOVES, DRIVE], ids=["discrete", "continuous"])
def test_memory_is_forgotten_exactly_where_episodes_begin(rng: np.random.Generator, action: ArraySpec):
    """Five steps at once are the same as one at a time, and an episode that begins is one that nothing went before."""
    specs = {"goal": SPECS["goal"]}
    agent = RecurrentAgent.from_specs(specs, action, SMALL)
    net, obs = agent.init_net(jax.random.key(1)), observations(rng, 5, 3, specs)
    begins = jnp.zeros((5, 3), bool).at[2, 1].set(True)
    memory = jnp.asarray(rng.normal(size=(3, 8)), jnp.float32)
    read = jax.jit(agent.unroll)
    last, params, value = read(net, memory, obs, begins)
    one_by_one = memory
    read_one = jax.jit(agent.unroll_step)
    for t in range(5):
        one_by_one, p, v = read_one(net, one_by_one, {"goal": obs["goal"][t]}, begins[t])
        np.testing.assert_allclose(p, params[t], atol=1e-6)
        np.testing.assert_allclose(v, value[t], atol=1e-6)
    np.testing.assert_allclose(one_by_one, last, atol=1e-6)
    fresh = read(net, jnp.zeros((3, 8)), {"goal": obs["goal"][2:]}, jnp.zeros((3, 3), bool))[2]
    np.testing.assert_allclose(fresh[:, 1], value[2:, 1], atol=1e-6)
    assert np.all(np.abs(fresh[:, [0, 2]] - value[2:, [0, 2]]) > 1e-4)


@pytest.fixture(scope="module")
def reader():
    """An agent that observes everything, a network for it, and its program."""
    agent = RecurrentAgent.from_specs(SPECS, DRIVE, SMALL)
    return agent, agent.init_net(jax.random.key(0)), jax.jit(agent.unroll)


def test_features_of_any_size_leave_the_memory_open(rng: np.random.Generator, reader):
    """Of agents with many images features grew to 35 in fifty steps, and seven in eight numbers of memory were at 1."""
    obs, begins = observations(rng, 1, 6), jnp.ones((1, 6), bool)
    agent, given, read = reader
    net = jax.tree.map(lambda x: x, given)
    last = max(
        (name for name in net["params"]["Encoder_0"] if name.startswith("Dense")), key=lambda name: int(name[6:])
    )
    net["params"]["Encoder_0"][last]["kernel"] *= 10.0  # so that they are well above what the norm adds against zero
    large = jax.tree.map(lambda x: x, net)
    large["params"]["Encoder_0"][last]["kernel"] *= 1000.0
    found = read(net, agent.initial_memory(6), obs, begins)
    for own, other in zip(read(large, agent.initial_memory(6), obs, begins), found, strict=True):
        np.testing.assert_allclose(own, other, rtol=1e-3, atol=1e-4)
    assert np.std(found[0], axis=0).mean() > 0.01


def test_every_observation_is_read(rng: np.random.Generator, reader):
    agent, net, read = reader
    obs, begins, memory = observations(rng, 1, 6), jnp.ones((1, 6), bool), agent.initial_memory(6)
    value = read(net, memory, obs, begins)[2]
    for name, x in obs.items():
        other = observations(np.random.default_rng(1), 1, 6)[name].at[0, 1].set(x[0, 1])
        changed = read(net, memory, obs | {name: other}, begins)[2]
        assert abs(changed - value)[0, 0] > 1e-5, name
        assert changed[0, 1] == value[0, 1], name


def test_words_tell_images_what_to_look_for(rng: np.random.Generator):
    """What the words change in the features is not the same whatever the image: their two effects do not just add."""
    specs = {name: SPECS[name] for name in ("pixels/head_depth", "instruction")}
    encoder = Encoder(tuple(specs.items()), 16, (4, 8))
    one, other = (observations(np.random.default_rng(seed), 1, 1, specs) for seed in (0, 1))
    net = jax.jit(encoder.init)(jax.random.key(0), one)
    apply = jax.jit(lambda obs: encoder.apply(net, obs, capture_intermediates=True)[1]["intermediates"])

    def seen(image: dict, words: dict) -> np.ndarray:
        obs = {"pixels/head_depth": image["pixels/head_depth"], "instruction": words["instruction"]}
        return np.asarray(apply(obs)["ImageEncoder_0"]["__call__"][0])

    assert np.abs(seen(one, one) - seen(one, other)).max() > 1e-3
    assert np.abs(seen(one, one) - seen(one, other) - seen(other, one) + seen(other, other)).max() > 1e-4


def test_bfloat16_is_only_inside(rng: np.random.Generator):
    specs = {"pixels/head_depth": SPECS["pixels/head_depth"]}
    exact = RecurrentAgent.from_specs(specs, DRIVE, SMALL)
    half = RecurrentAgent.from_specs(
        specs, DRIVE, NetworkConfig(features=16, memory=8, channels=(4, 8), dtype="bfloat16")
    )
    net, obs = half.init_net(jax.random.key(0)), observations(rng, 1, 4, specs)
    assert {x.dtype for x in jax.tree.leaves(net)} == {jnp.dtype("float32")}
    begins = jnp.ones((1, 4), bool)
    a, b = (jax.jit(agent.unroll)(net, agent.initial_memory(4), obs, begins)[2] for agent in (exact, half))
    assert b.dtype == jnp.float32
    assert 0 < jnp.max(jnp.abs(a - b)) < 0.02 * jnp.max(jnp.abs(a))


@pytest.mark.parametrize("option", [{"features": 0}, {"channels": ()}, {"channels": (0,)}, {"dtype": "float64"}])
def test_unusable_sizes_are_refused(option: dict):
    with pytest.raises(ConfigError, match=next(iter(option))):
        NetworkConfig(**option)
