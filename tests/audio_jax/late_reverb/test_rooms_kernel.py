"""The kernels of rooms: Numba's, and CUDA's compiled as C++, give what the matrix exponential does."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from compiled_kernels import block_program, blocks_instead, nvrtc_ptx, shared_library
from scipy.linalg import expm

from home_mjx.audio_jax.late_reverb.lookup import coupled_decay, room_matrices

ARGUMENTS = "(float*)p[0], (float*)p[1], (float*)p[2], (int*)p[3], (int*)p[4], (float*)p[5]"


@pytest.fixture
def on_cpu():
    """Arrays are on the CPU, also where a GPU is the default device."""
    with jax.default_device(jax.devices("cpu")[0]):
        yield


def random_rates(rng, size, states, octaves):
    """Rates of two environments, float64, with starts and listeners."""
    most = 0.2 * min(1, 32 / size)  # as much to all others together from 50 rooms as from 32
    exchange = rng.uniform(0, most, (2, states, octaves, size, size)) * (1 - np.eye(size))
    own = exchange.sum(axis=-1) + rng.uniform(0.01, 0.5, (2, states, octaves, size))
    return own[..., None] * np.eye(size) - exchange, *rng.uniform(0, 1, (2, 2, size))


def by_the_exponential(rates, start, listener, bins):
    """Energy in each bin, of one environment, state and octave: float64, by powers of the matrix of one bin."""
    step, wanted = expm(-rates), []
    for _ in range(bins):
        wanted.append(listener @ start)
        start = step @ start
    return wanted


@pytest.fixture
def here(tmp_path, monkeypatch):
    """Calls of XLA run the kernel on the CPU."""

    def compiled(name, given, threads):
        defines = {"ROOMS": given[1].shape[1], "MAX_ELEMENTS": coupled_decay.MAX_REGISTER_ELEMENTS}
        return shared_library(tmp_path, block_program([coupled_decay.SOURCE], defines, name, ARGUMENTS))

    monkeypatch.setattr(coupled_decay, "ptx_of", lambda size: "")
    monkeypatch.setattr(jax.ffi, "ffi_call", blocks_instead(compiled))


@pytest.mark.parametrize(
    ("size", "states", "octaves", "bins"),
    [(1, 1, 3, 40), (5, 3, 7, 125), (8, 3, 7, 125), (17, 2, 7, 33), (32, 1, 2, 64), (50, 1, 2, 64)],
)
def test_energy_falls_as_by_the_matrix_exponential(here, rng, size, states, octaves, bins):
    """In one room and in as many as registers hold, any number of bins, blocks with and without matrices to spare."""
    rates, start, listener = random_rates(rng, size, states, octaves)
    counts = jnp.full(2, size, jnp.int32)
    (got,) = coupled_decay.launch_decay(bins, *(jnp.float32(x) for x in (rates, start, listener)), counts)
    assert got.shape == (2, states, bins, octaves)
    for env, state, octave in np.ndindex(2, states, octaves):
        wanted = by_the_exponential(rates[env, state, octave], start[env], listener[env], bins)
        np.testing.assert_allclose(got[env, state, :, octave], wanted, rtol=2e-4, atol=1e-9)


@pytest.mark.parametrize(
    ("size", "states", "octaves", "bins"),
    [(1, 1, 3, 40), (5, 3, 7, 125), (8, 3, 7, 125), (17, 2, 7, 33), (40, 1, 2, 64)],
)
def test_the_cpu_kernel_follows_the_matrix_exponential(on_cpu, rng, size, states, octaves, bins):
    """In any number of rooms that its memory holds, also where numbers of bins are no multiple of its runs."""
    assert coupled_decay.KERNEL.is_usable("cpu")
    rates, start, listener = random_rates(rng, size, states, octaves)
    given = (jnp.float32(x) for x in (rates, start, listener))
    got = jax.vmap(lambda *one: coupled_decay._decay_by_cpu(*one, jnp.int32(size), bins=bins))(*given)
    assert got.shape == (2, states, bins, octaves)
    for env, state, octave in np.ndindex(2, states, octaves):
        wanted = by_the_exponential(rates[env, state, octave], start[env], listener[env], bins)
        np.testing.assert_allclose(got[env, state, :, octave], wanted, rtol=2e-4, atol=1e-9)


def test_houses_beyond_the_cpu_kernel_take_xla(rng):
    """A house of more rooms than its memory holds gives the same energies, and the gradient stays XLA's."""
    size = room_matrices.MAX_STACK_ROOMS + 1
    rates, start, listener = (jnp.float32(x[0]) for x in random_rates(rng, size, 1, 2))
    got = coupled_decay.decay_in_rooms(rates, start, listener, 20)
    np.testing.assert_allclose(
        got, room_matrices.decay_in_rooms_by_xla(rates, start, listener, 20), rtol=2e-4, atol=1e-9
    )


def test_gradients_are_those_of_xla(rng):
    """Of the energy with respect to the rates, with the CPU kernel in the forward pass."""
    rates, start, listener = (jnp.float32(x[0]) for x in random_rates(rng, 4, 1, 2))
    ours = jax.jit(jax.grad(lambda x: coupled_decay.decay_in_rooms(x, start, listener, 30).sum()))(rates)
    theirs = jax.jit(jax.grad(lambda x: room_matrices.decay_in_rooms_by_xla(x, start, listener, 30).sum()))(rates)
    np.testing.assert_allclose(ours, theirs, rtol=1e-3, atol=1e-4)


def test_it_gives_what_xla_does(here, rng, monkeypatch):
    """In the same order of states, bins and octaves."""
    alone = lambda launch, options, shared, given: launch(*options, *shared, *(x[None] for x in given))[0][0]  # noqa: E731
    monkeypatch.setattr(coupled_decay, "call_kernel", alone)
    rates = jnp.float32(np.eye(4) * rng.uniform(0.1, 0.4, (2, 3, 7, 1, 4)))
    start, listener = (jnp.float32(rng.uniform(0, 1, (2, 4))) for _ in range(2))
    wanted = jax.vmap(lambda *one: room_matrices.decay_in_rooms_by_xla(*one, 125))(rates, start, listener)
    counts = jnp.full(2, 4, jnp.int32)
    each = zip(rates, start, listener, counts, strict=True)
    got = jnp.stack([coupled_decay._decay_by_cuda(*one, bins=125) for one in each])
    np.testing.assert_allclose(got, wanted, rtol=2e-4, atol=1e-9)


@pytest.fixture
def padded(rng):
    """Rates, starts, listeners and numbers of rooms of houses of 3, 11, 17 and 30 rooms; their energies by XLA."""
    counts = np.array([3, 11, 17, 30])
    inside = np.arange(32)[None] < counts[:, None]
    exchange = rng.uniform(0, 0.1, (4, 2, 7, 32, 32)) * (1 - np.eye(32))
    exchange *= (inside[:, :, None] & inside[:, None])[:, None, None]
    own = exchange.sum(axis=-1) + rng.uniform(0.01, 0.5, (4, 2, 7, 32))
    rates = jnp.float32(own[..., None] * np.eye(32) - exchange)
    start, listener = (jnp.float32(x * inside) for x in rng.uniform(0, 1, (2, 4, 32)))
    wanted = jax.vmap(lambda *one: room_matrices.decay_in_rooms_by_xla(*one, 60))(rates, start, listener)
    return (rates, start, listener, jnp.int32(counts)), wanted


def test_padding_changes_nothing(here, padded):
    """In one batch, each house computed at a size of its own."""
    (got,) = coupled_decay.launch_decay(60, *padded[0])
    np.testing.assert_allclose(got, padded[1], rtol=2e-4, atol=1e-9)


def test_padding_changes_nothing_on_cpus(on_cpu, padded):
    """In one batch, each house computed with its own number of rooms."""
    got = jax.vmap(lambda *one: coupled_decay._decay_by_cpu(*one, bins=60))(*padded[0])
    np.testing.assert_allclose(got, padded[1], rtol=2e-4, atol=1e-9)


def test_nvrtc_compiles_it():
    """If it is here."""
    for size in (1, 8, 32):
        defines = {"ROOMS": size, "MAX_ELEMENTS": coupled_decay.MAX_REGISTER_ELEMENTS}
        assert ".entry" in nvrtc_ptx(coupled_decay.SOURCE, 90, defines)
