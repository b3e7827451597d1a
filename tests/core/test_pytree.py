import jax
import jax.numpy as jnp
import pytest

from home_mjx.raycast_render.scene.types import Hit


def make() -> Hit:
    return Hit(
        t=jnp.float32(1.0),
        instance=jnp.int32(0),
        triangle=jnp.int32(0),
        u=jnp.float32(0.0),
        v=jnp.float32(0.0),
        front=jnp.array(True),
    )


def test_records_pass_through_transformations():
    out = jax.jit(jax.vmap(lambda t: make().replace(t=t)))(jnp.arange(3.0))
    assert out.t.shape == (3,)
    assert jax.tree.structure(jax.tree.map(lambda _: None, out)) is not None
    assert jax.tree.map(lambda x: object(), out).t is not out.t


def test_records_are_frozen():
    with pytest.raises(AttributeError):
        make().t = 2
