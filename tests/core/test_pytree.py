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


@pytest.mark.parametrize("build", [lambda **x: make().replace(**x), Hit.build_unchecked])
def test_unknown_names_of_fields_are_refused(build):
    with pytest.raises(TypeError, match=r"^Hit has no field look, sounds; it has .*\bfront\b"):
        build(sounds=0, t=0, look=0)
