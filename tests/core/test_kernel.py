"""Native kernels: registration, availability, and chunks of work on XLA's threads."""

import time
import warnings
from concurrent.futures import ThreadPoolExecutor
from typing import no_type_check

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from numba import cfunc, njit, types

from home_mjx.core.native import ffi
from home_mjx.core.native import kernel as native_kernel
from home_mjx.core.native.handler import WORD_FUNCTION
from home_mjx.core.native.inner import compile_inner
from home_mjx.core.native.kernel import Kernel, call_native, launch_ptx
from home_mjx.core.native.memory import pointer_to
from home_mjx.core.native.vmap_call import batch_kernel
from home_mjx.errors import BackendError

pytestmark = pytest.mark.cpu

ROWS, WIDTH, CHUNK = 1000, 300, 3
floats = pointer_to(types.float32)


@njit
def scale_chunk(frame, chunk):
    factor = ffi.attribute(frame, 0)
    for row in range(chunk * CHUNK, min((chunk + 1) * CHUNK, ffi.dim(frame, ffi.OPERANDS, 0, 0))):
        given, result = floats(ffi.row(frame, ffi.OPERANDS, 0, row)), floats(ffi.row(frame, ffi.RESULTS, 0, row))
        for i in range(ffi.dim(frame, ffi.OPERANDS, 0, 1)):
            result[i] = factor * given[i]


def compile_chunks():
    @cfunc(WORD_FUNCTION)
    def count(frame):
        return -(-ffi.dim(frame, ffi.OPERANDS, 0, 0) // CHUNK)

    @cfunc(WORD_FUNCTION)
    def work(job):
        ffi.run_chunks(job, scale_chunk)
        return 0

    return count, work


def scale(name, values):
    return call_native(name, (values,), (jax.ShapeDtypeStruct(values.shape, jnp.float32),), factor=3)[0]


@pytest.fixture(scope="module")
def kernel():
    return Kernel("test_scale", "slower", cpu=compile_chunks)


@pytest.mark.parametrize("rows", [0, 1, CHUNK, CHUNK + 1, ROWS])
def test_every_chunk_is_computed(kernel, rows):
    assert kernel.find_problem("cpu") is None
    values = jnp.asarray(np.random.default_rng(rows).normal(size=(rows, WIDTH)), jnp.float32)
    found = jax.jit(lambda x: scale(kernel.name, x))(values)
    np.testing.assert_array_equal(found, 3 * np.asarray(values))


def test_small_integers_are_converted_to_int32(kernel):
    """This kernel reads their bits as floats; an integer of the bits of 1.5 becomes 4.5."""
    assert kernel.is_usable("cpu")
    bits = int(np.float32(1.5).view(np.int32))
    assert scale(kernel.name, jnp.full((1, 1), bits, jnp.uint32)).tolist() == [[4.5]]


def test_the_fallback_runs_without_a_version_for_the_platform(kernel):
    values, native = jnp.ones((3, 4), jnp.float32), {"cpu": lambda x: scale("test_scale", x)}
    for each, factor in ((kernel, 3), (Kernel("test_none", "slower"), 2)):
        found = jax.jit(lambda x, each=each: each.select(lambda y: 2 * y, native, x))(values)
        np.testing.assert_array_equal(found, factor * values)


@pytest.fixture
def deferred(monkeypatch):
    """A kernel in a process whose default platform is not the CPU, and the list of its compilations."""
    compilations = []
    later = Kernel("test_deferred", "slower", cpu=lambda: (compilations.append(1), compile_chunks())[1])
    monkeypatch.setattr(native_kernel, "_is_cpu_default", lambda: False)
    monkeypatch.setattr(native_kernel, "_deferred", {})
    return later, compilations


def test_where_gpus_are_the_default_tracing_compiles_nothing_for_the_cpu(deferred):
    kernel, compilations = deferred
    scaled = lambda x: kernel.select(lambda y: 2 * y, {"cpu": lambda y: scale(kernel.name, y)}, x)  # noqa: E731
    values = jnp.ones((2, 3, 4), jnp.float32)
    jax.make_jaxpr(scaled)(values[0])
    assert not compilations
    looped = jax.jit(lambda x: jax.lax.map(scaled, x))
    for _ in range(2):
        np.testing.assert_array_equal(looped(values), 3 * values)
    assert len(compilations) == 1


def test_a_deferred_kernel_runs_in_its_own_test(deferred):
    kernel, compilations = deferred
    values = jnp.ones((2, 3), jnp.float32)
    own = Kernel(
        "test_deferred_own",
        "slower",
        cpu=kernel.cpu,
        test=lambda platform: None if scale("test_deferred_own", values)[0, 0] == 3 else "wrong",
    )
    assert own.is_usable("cpu")
    np.testing.assert_array_equal(jax.jit(lambda x: scale(own.name, x))(values), 3 * values)
    assert len(compilations) == 1


def test_threads_that_ask_at_once_start_a_kernel_once():
    """XLA refuses a second registration, and the kernel would count as broken."""
    compilations = []

    def compile_slowly():
        compilations.append(1)
        time.sleep(0.2)
        return compile_chunks()

    kernel = Kernel("test_threads", "slower", cpu=compile_slowly)
    with ThreadPoolExecutor(4) as threads:
        problems = list(threads.map(lambda _: kernel.find_problem("cpu"), range(4)))
    assert problems == [None] * 4
    assert len(compilations) == 1


def test_a_fault_that_lowering_for_the_cpu_finds_is_an_error(monkeypatch):
    broken = Kernel("test_broken_later", "sums are slower", cpu=compile_chunks, test=lambda platform: "wrong")
    monkeypatch.setattr(native_kernel, "_is_cpu_default", lambda: False)
    assert broken.is_usable("cpu")
    with pytest.raises(BackendError, match="test_broken_later does not work on the CPU: wrong") as caught:
        jax.jit(lambda x: scale(broken.name, x))(jnp.ones((2, 2), jnp.float32))
    assert "JAX_PLATFORMS=cpu" in caught.value.hint


def test_a_wrong_self_test_warns_once_and_is_the_reason():
    broken = Kernel("test_broken", "sums are slower", cpu=compile_chunks, test=lambda platform: f"wrong on {platform}")
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        assert not any(broken.is_usable("cpu") for _ in range(3))
    assert [str(w.message) for w in caught] == ["sums are slower: wrong on cpu"]
    with pytest.raises(BackendError, match="`scale` is not available: wrong on cpu"):
        broken.check_usable("cpu", "`scale`", "Use another.")


def test_a_kernel_without_a_version_for_a_platform_says_so_without_a_warning():
    only_cuda = Kernel("test_only_cuda", "slower", cuda=lambda: None)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert only_cuda.find_problem("cpu") == "the kernel has no version for this platform"
        assert not only_cuda.is_usable("cpu")


@pytest.mark.parametrize(("grid", "wanted"), [((5,), (5, 1, 1)), ((5, 6), (5, 6, 1)), ((5, 6, 7), (5, 6, 7))])
def test_a_launch_has_three_axes_and_all_results(grid, wanted):
    results = [jax.ShapeDtypeStruct((2,), jnp.float32), jax.ShapeDtypeStruct((3,), jnp.int32)]
    run = jax.jit(lambda x: launch_ptx("entry", "the PTX", grid, 64, 1024, (x,), results))
    text = run.trace(jnp.zeros(4, bool)).lower(lowering_platforms=("cuda",)).as_text()
    (call,) = (line for line in text.splitlines() if "xla.gpu.ptx" in line)
    numbers = dict(zip(("grid_x", "grid_y", "grid_z"), wanted, strict=True))
    numbers |= {"block_x": 64, "block_y": 1, "block_z": 1, "shared_mem_bytes": 1024}
    assert all(f"{name} = {value} : i32" in call for name, value in numbers.items())
    assert "(tensor<4xi32>) -> (tensor<2xf32>, tensor<3xi32>)" in call


def test_shared_operands_may_be_mapped_inside_another_vmap():
    """The kernel itself has no rule for `vmap`, as native code has none."""

    def run(shared, own):
        shape = jax.ShapeDtypeStruct(own.shape, own.dtype)
        return (jax.pure_callback(lambda a, b: np.asarray(a) * np.asarray(b), shape, shared, own),)

    step = batch_kernel(run, 1, 1)
    shared, own = jnp.arange(1.0, 4.0), jnp.arange(24.0).reshape(2, 3, 4)
    inner = jax.vmap(lambda factor, rows: step(factor, rows)[0])
    found = jax.jit(jax.vmap(inner, (None, 0)))(shared, own)
    np.testing.assert_array_equal(found, shared[None, :, None] * own)


def test_inner_functions_are_linked_and_refuse_calls_from_python():
    inner = compile_inner()(no_type_check(lambda x: 2 * x + 1))
    outer = njit(no_type_check(lambda x: inner(x) + inner(inner(x))))
    assert (outer(3), outer(0.5)) == (7 + 15, 2.0 + 5.0)
    for _ in range(2):
        with pytest.raises(TypeError):
            inner(3)
    with pytest.raises(TypeError):
        inner(np.ones(3))  # of types that nothing has compiled
