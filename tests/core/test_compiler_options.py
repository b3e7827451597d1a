"""Options of XLA: accepted by this version's compiler, and overridden by the user's own."""

import jax
import pytest

from home_mjx.core.compile_cache import CPU_OPTIONS, GPU_OPTIONS, compiler_options


def test_this_compiler_knows_the_options(monkeypatch: pytest.MonkeyPatch):
    """XLA refuses names that it does not know."""
    monkeypatch.delenv("XLA_FLAGS", raising=False)
    assert int(jax.jit(lambda x: x + 1, compiler_options=compiler_options())(1)) == 2


@pytest.mark.parametrize(("backend", "options"), [("gpu", GPU_OPTIONS), ("cpu", CPU_OPTIONS), ("tpu", {})])
@pytest.mark.parametrize("jaxlib", ["0.10.2", "0.11.0", "1.0"])
def test_options_are_those_of_the_backend_and_version(backend: str, options: dict, jaxlib: str, monkeypatch):
    monkeypatch.delenv("XLA_FLAGS", raising=False)
    monkeypatch.setattr("home_mjx.core.compile_cache.version", lambda name: jaxlib)
    monkeypatch.setattr(jax, "default_backend", lambda: backend)
    assert compiler_options() == ({} if backend == "cpu" and jaxlib != "0.10.2" else options)


def test_what_the_user_chose_stays(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("home_mjx.core.compile_cache.version", lambda name: "0.10.2")
    monkeypatch.setattr(jax, "default_backend", lambda: "cpu")
    monkeypatch.setenv("XLA_FLAGS", "--xla_dump_to=x --xla_backend_optimization_level=0")
    assert set(compiler_options()) == {"xla_cpu_use_fusion_emitters"}
