"""Shorter compilation: a persistent cache of JAX programs for later processes, and options of XLA for new ones."""

import functools
import hashlib
import os
import platform
import sys
from importlib.metadata import version
from pathlib import Path

from home_mjx.core.paths import cache_folder

FOLDER_VARIABLE = "JAX_COMPILATION_CACHE_DIR"
OPTIONS = {
    "jax_compilation_cache_dir": FOLDER_VARIABLE,
    "jax_persistent_cache_min_compile_time_secs": "JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS",
}
MIN_COMPILE_SECONDS = "0.1"  # [s], minimum compile time of a cached program
# XLA chooses kernels by their times as by default, but does not check the results of each candidate.
GPU_OPTIONS: dict[str, str | bool] = {"xla_gpu_autotune_level": "1"}
# Loops of a step are as fast, and compile in half the time. Shaders such as `lit` are half as fast.
CPU_OPTIONS: dict[str, str | bool] = {"xla_backend_optimization_level": "1", "xla_cpu_use_fusion_emitters": False}
LAST_CPU_OPTIONS = (0, 10)  # last minor version of jaxlib that has `CPU_OPTIONS`


def use_compile_cache() -> Path | None:
    """Enable JAX's persistent compilation cache, for this process and its children; return its folder.

    Call it before the first program is compiled. The command line calls it automatically. A cache chosen by the user,
    through `JAX_COMPILATION_CACHE_DIR` or JAX's own configuration, is kept; set that variable to "" to disable caching.

    Returns:
        The folder; None if caching is disabled.

    Example:
        >>> home_mjx.use_compile_cache()  # doctest: +SKIP
        PosixPath('/home/me/.cache/home_mjx/programs-5f0c2a91')
    """
    if FOLDER_VARIABLE not in os.environ:
        chosen = _configured_folder()
        os.environ[FOLDER_VARIABLE] = chosen or str(cache_folder() / f"programs-{_processor()}")
        os.environ.setdefault(OPTIONS["jax_persistent_cache_min_compile_time_secs"], MIN_COMPILE_SECONDS)
        if "jax" in sys.modules and chosen is None:  # JAX reads the environment only once, at import
            _configure_jax()
    return Path(os.environ[FOLDER_VARIABLE]) if os.environ[FOLDER_VARIABLE] else None


def compiler_options() -> dict[str, str | bool]:
    """Return options with which XLA compiles steps and training updates in about half the time on JAX's backend.

    Programs are as fast as without them; only the last bits of results may differ. They do not suit programs whose
    main work is the shader `lit` on a CPU. Options that `XLA_FLAGS` names are left out, and so are all options on CPUs
    with jaxlib 0.11 or later, which does not have them.

    Example:
        >>> import jax
        >>> step = jax.jit(lambda x: x + 1, compiler_options=compiler_options())
        >>> int(step(1))
        2
    """
    import jax

    backend, flags = jax.default_backend(), os.environ.get("XLA_FLAGS", "")
    options = {"gpu": GPU_OPTIONS, "cpu": CPU_OPTIONS}.get(backend, {})
    if backend == "cpu" and tuple(map(int, version("jaxlib").split(".")[:2])) > LAST_CPU_OPTIONS:
        options = {}
    return {name: value for name, value in options.items() if f"--{name}=" not in flags}


def describe_compile(name: str) -> str:
    """Return a text for the compilation of a program, which says for how long the program is kept.

    Example:
        >>> describe_compile("step")  # doctest: +SKIP
        'compiling step (kept for later runs)'
    """
    if os.environ.get(FOLDER_VARIABLE) or _configured_folder():
        return f"compiling {name} (kept for later runs)"
    return f"compiling {name} (for this process; `home_mjx.use_compile_cache()` would keep it)"


def _configured_folder() -> str | None:
    """Return the folder of JAX's configuration; None if JAX is not imported or no folder is set."""
    return getattr(sys.modules["jax"].config, "jax_compilation_cache_dir", None) if "jax" in sys.modules else None


def _configure_jax() -> None:
    """Copy the cache's environment variables to the configuration of JAX, which is already imported."""
    import jax

    for option, variable in OPTIONS.items():
        jax.config.update(option, os.environ[variable] if option.endswith("dir") else float(os.environ[variable]))


@functools.cache
def _processor() -> str:
    """Return a hash (8 hexadecimal digits) of the processor model and its flags.

    Code that XLA compiles for one processor may crash on another that shares the folder.
    """
    facts = [platform.machine(), platform.processor()]
    info = Path("/proc/cpuinfo")
    if info.is_file():
        lines = info.read_text(errors="replace").splitlines()
        facts += [next((line for line in lines if line.startswith(name)), "") for name in ("model name", "flags")]
    return hashlib.sha256("\n".join(facts).encode()).hexdigest()[:8]
