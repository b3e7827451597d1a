"""Check whether this machine is ready, and suggest fixes. Exit code 1 if something is broken."""

import argparse
import importlib.metadata as metadata
import json
import os
import platform
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import asdict, dataclass

from home_mjx.core.compile_cache import use_compile_cache
from home_mjx.core.paths import CACHE_VARIABLE, ROOT_VARIABLE, cache_folder, dataset_root
from home_mjx.errors import HomeMjxError

OK, NOTE, BROKEN = "ok", "note", "broken"
OPTIONAL_PACKAGES = ("brax", "flax", "matplotlib", "mujoco-warp", "warp-lang")


@dataclass(frozen=True)
class CheckResult:
    """One line of the report."""

    topic: str
    status: str  # OK, NOTE or BROKEN
    detail: str


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the flag `--json` (`json`, False) of `home-mjx doctor`: print one JSON object per line."""
    parser.add_argument("--json", action="store_true", help="print one JSON object per line")


def run(args: argparse.Namespace) -> int:
    """Print one line per finding; return 1 if one is `BROKEN`, else 0.

    A line has padded status, padded topic and detail. With `--json` it is an object with `topic`, `status` and
    `detail`.
    """
    broken = False
    for finding in run_checks():
        broken |= finding.status == BROKEN
        line = json.dumps(asdict(finding)) if args.json else f"{finding.status:<7} {finding.topic:<14} {finding.detail}"
        sys.stdout.write(line + "\n")
    return int(broken)


def run_checks() -> Iterator[CheckResult]:
    """Yield all findings, quick checks first.

    A check that raises yields a finding `BROKEN` with its own name as topic, after those that it has yielded.
    """
    checks = (_python, _packages, _extras, _known_bad_pairs, _devices, _backends, _ffmpeg, _caches, _dataset)
    for check in checks:
        try:
            yield from check()
        except Exception as error:  # any error is a finding for the user
            yield CheckResult(check.__name__.strip("_"), BROKEN, f"{type(error).__name__}: {error}")


def _python() -> Iterator[CheckResult]:
    """Yield one result `OK`: version of Python, system, machine type and number of processors."""
    detail = f"{platform.python_version()} on {platform.system()} {platform.machine()}, {os.cpu_count()} processors"
    yield CheckResult("python", OK, detail)


def _packages() -> Iterator[CheckResult]:
    """Yield a result per package, sorted by name: `OK` with its version, or `BROKEN` if it is not installed.

    The packages are `home-mjx`, `jaxlib` and each dependency outside of extras. Versions are not compared with the
    required ones. `PackageNotFoundError` is raised if `home-mjx` itself has no metadata.
    """
    required = [r for r in metadata.requires("home-mjx") or [] if "extra ==" not in r]
    for name in sorted({_project_name(r) for r in required} | {"home-mjx", "jaxlib"}):
        version = _version(name)
        if version is None:
            yield CheckResult(name, BROKEN, f"not installed. Try: pip install {name}")
        else:
            yield CheckResult(name, OK, version)


def _extras() -> Iterator[CheckResult]:
    """Yield one result `OK` with name and version of each installed package of `OPTIONAL_PACKAGES`, or none."""
    found = [f"{name} {version}" for name in OPTIONAL_PACKAGES if (version := _version(name))]
    yield CheckResult("extras", OK, ", ".join(found) or "none installed")


def _known_bad_pairs() -> Iterator[CheckResult]:
    """Yield a result for each known fault of the installed versions of JAX, and of Brax or Flax with it; else nothing.

    Flax from 0.12.7 on with JAX below 0.10 is `BROKEN`. The others have a workaround, so they are a `NOTE`: Brax up to
    0.14.2 where JAX lacks `device_put_replicated`, and JAX 0.11. Errors of importing JAX are raised.
    """
    import jax

    brax, flax = _version("brax"), _version("flax")
    if brax and _version_numbers(brax) <= (0, 14, 2) and not hasattr(jax, "device_put_replicated"):
        text = f"brax {brax} calls jax.device_put_replicated, which jax {jax.__version__} lacks: before "
        yield CheckResult("brax", NOTE, text + "brax.training, call home_mjx.training.brax_compat.install()")
    if flax and _version_numbers(flax) >= (0, 12, 7) and _version_numbers(jax.__version__) < (0, 10):
        yield CheckResult(
            "flax", BROKEN, f"flax {flax} needs jax >= 0.10, found {jax.__version__}. Install flax==0.12.6"
        )
    if _version_numbers(jax.__version__)[:2] == (0, 11):
        text = f"jaxlib {jax.__version__} crashes when it compiles `jax.shard_map` of a step over several devices"
        yield CheckResult("jax", NOTE, text + "; `EnvSharding` works, and so do 0.10 and 0.12")


def _devices() -> Iterator[CheckResult]:
    """Yield `OK` for each of JAX's devices, with platform, kind and id; errors of JAX are raised."""
    import jax

    for device in jax.devices():
        yield CheckResult("device", OK, f"{device.platform} {device.device_kind} (id {device.id})")


def _backends() -> Iterator[CheckResult]:
    """Yield one result per ray-casting backend, in the order xla, cpu, cuda.

    `xla` is `OK` unconditionally. The others are `OK` if they work here, else `NOTE` with the reason; none is `BROKEN`.
    """
    from home_mjx.raycast_render.backends.registry import KERNEL

    yield CheckResult("backend xla", OK, "the reference, runs everywhere")
    problem = KERNEL.find_problem("cpu")
    detail = f"does not work: {problem}; `xla` is used instead, slower on a CPU" if problem else "compiled by Numba"
    yield CheckResult("backend cpu", NOTE if problem else OK, detail)
    yield _cuda_backend()


def _cuda_backend() -> CheckResult:
    """Return `OK` with version of NVRTC and cache folder if the `cuda` backend works, else `NOTE` with the reason.

    It is a `NOTE` without an NVIDIA GPU, too. It is never `BROKEN`, since `xla` replaces it.
    """
    from home_mjx.core.native import nvrtc
    from home_mjx.core.native.platforms import local_devices
    from home_mjx.raycast_render.backends.registry import KERNEL

    if not local_devices("cuda"):
        return CheckResult("backend cuda", NOTE, "JAX has no NVIDIA GPU here")
    problem = KERNEL.find_problem("cuda")
    if problem:
        return CheckResult("backend cuda", NOTE, f"does not work: {problem}; `xla` is used instead, slower")
    version = ".".join(map(str, nvrtc.version(nvrtc.find_library())))
    return CheckResult("backend cuda", OK, f"compiled by NVRTC {version}, cached in {cache_folder() / 'kernels'}")


def _ffmpeg() -> Iterator[CheckResult]:
    """Yield one result `OK` with version and path of ffmpeg.

    Errors are raised: no ffmpeg is found, it fails, or it takes more than 60 s.
    """
    import imageio_ffmpeg

    program = imageio_ffmpeg.get_ffmpeg_exe()
    shown = subprocess.run([program, "-version"], capture_output=True, text=True, timeout=60, check=True).stdout
    yield CheckResult("ffmpeg", OK, f"{shown.split(' Copyright')[0]} at {program}")


def _caches() -> Iterator[CheckResult]:
    """Yield a result for the cache folder, then one for JAX's compilation cache.

    The folder is `OK` if it is writable, else `BROKEN`; if missing, its nearest parent that exists is tested. JAX's
    cache, which this check enables, is `OK` with its folder, or `NOTE` if disabled.
    """
    folder = cache_folder()
    nearest = next(p for p in (folder, *folder.parents) if p.exists())
    try:
        with tempfile.TemporaryFile(dir=nearest):
            yield CheckResult("house cache", OK, str(folder))
    except OSError as error:
        text = f"cannot write to {nearest}: {error.strerror}. Set {CACHE_VARIABLE} to a writable folder"
        yield CheckResult("house cache", BROKEN, text)
    programs = use_compile_cache()
    advice = "none: unset JAX_COMPILATION_CACHE_DIR, so that later starts do not compile again"
    yield CheckResult("jax cache", OK if programs else NOTE, str(programs or advice))


def _dataset() -> Iterator[CheckResult]:
    """Yield one result for the dataset that `$SUNCG_DATA_DIR` names: `OK` with its number of houses.

    It is `NOTE` if the variable is not set, `BROKEN` if a `HomeMjxError` is raised on opening. Other errors come
    through.
    """
    from home_mjx.datasets.registry import open_dataset

    root = dataset_root()
    if root is None:
        yield CheckResult("dataset", NOTE, f"{ROOT_VARIABLE} is not set: houses are generated")
        return
    try:
        dataset = open_dataset(root)
    except HomeMjxError as error:
        yield CheckResult("dataset", BROKEN, str(error))
    else:
        yield CheckResult("dataset", OK, f"{len(dataset.house_ids)} houses in {root}")


def _version(name: str) -> str | None:
    """Return the version of an installed package; None if it is missing."""
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return None


def _project_name(requirement: str) -> str:
    """Return the name at the start of a requirement, such as "jax" of "jax>=0.9"."""
    return next(requirement[:i] for i, c in enumerate(requirement + " ") if not (c.isalnum() or c in "-_."))


def _version_numbers(version: str) -> tuple[int, ...]:
    """Return the leading whole numbers of a version, such as (0, 12) of `0.12.6rc1`; () if there are none."""
    numbers: list[int] = []
    for part in version.split("."):
        if not part.isdecimal():
            break
        numbers.append(int(part))
    return tuple(numbers)
