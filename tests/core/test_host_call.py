"""Python functions that XLA calls: values, several at once, large arguments, errors."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from home_mjx.core.native.host_call import register_host_call

pytestmark = pytest.mark.cpu


def _mix(given, results):
    number, flag, whole, empty = given
    assert empty.shape == (0, 3)
    results[0][:] = np.where(flag, number, -number) + whole
    results[1][...] = number.sum()


def _raise(given, results):
    raise KeyError("no such thing")


register_host_call("home_mjx_test_mix", _mix)
register_host_call("home_mjx_test_raise", _raise)


def mix(number, flag, whole):
    shapes = jax.ShapeDtypeStruct(number.shape, jnp.float32), jax.ShapeDtypeStruct((), jnp.float32)
    return jax.ffi.ffi_call("home_mjx_test_mix", shapes)(number, flag, whole, jnp.zeros((0, 3)))


def test_types_and_shapes_are_those_of_the_program():
    number = jnp.arange(6.0).reshape(2, 3)
    got, total = jax.jit(mix)(number, number > 2, jnp.full((2, 3), 10, jnp.int32))
    np.testing.assert_array_equal(got, [[10, 9, 8], [13, 14, 15]])
    assert total == 15


def test_large_arguments_in_a_loop_on_all_devices_do_not_hang():
    """`jax.pure_callback` hangs here: it copies large arguments on the threads that wait for it."""
    devices = jax.devices()
    number = jnp.ones((len(devices), 1_000_000))

    def one(x):
        def body(x, _):
            return mix(x, x > 0, jnp.ones(x.shape, jnp.int32))[0], None

        return jax.lax.scan(body, x, None, length=20)[0]

    np.testing.assert_array_equal(jax.pmap(one)(number), 21.0)


def test_what_it_raises_reaches_the_caller():
    call = jax.ffi.ffi_call("home_mjx_test_raise", jax.ShapeDtypeStruct((), jnp.float32))
    with pytest.raises(Exception, match="KeyError: 'no such thing'"):
        jax.block_until_ready(jax.jit(call)(jnp.ones(())))
