"""Scenes that are stepped once for all tests."""

import jax.numpy as jnp
import pytest


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item):
    """C MuJoCo is called on CPUs only, and refuses elsewhere: see tests/physics/mujoco."""
    params = getattr(item, "callspec", None)
    if params and "c" in params.params.values():
        item.add_marker("cpu")


class World:
    """Bank, template, compiled run, and what happened in each scene during the first two seconds."""

    def __init__(self, impl):
        import rollouts  # here, since the package must not be imported before jaxtyping's hook

        self.rollouts = rollouts
        self.bank, self.template = rollouts.build(impl)
        self.run = rollouts.make_run(self.template)
        self.house = jnp.arange(rollouts.BATCH, dtype=jnp.int32)
        self.start = rollouts.start(self.bank, self.template, self.house)
        self.end, self.rollout = self.run(self.bank, self.house, self.start, rollouts.actions())

    def scene(self, name):
        index = self.rollouts.NAMES.index(name)
        return self.rollouts.Rollout(*(values[:, index] for values in self.rollout))


@pytest.fixture(scope="session", params=["jax", "fused", "c"])
def world(request):
    return World(request.param)
