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
    """Add the options of `home-mjx doctor`."""
    parser.add_argument("--json", action="store_true", help="print one JSON object per line")


def run(args: argparse.Namespace) -> int:
    """Print one line per finding, as JSON with `--json`; return 1 if something is broken, else 0."""
    broken = False
    for finding in run_checks():
        broken |= finding.status == BROKEN
        line = json.dumps(asdict(finding)) if args.json else f"{finding.status:<7} {finding.topic:<14} {finding.detail}"
        sys.stdout.write(line + "\n")
    return int(broken)


def run_checks() -> Iterator[CheckResult]:
    """Yield all findings, quick checks first; a check that raises yields a finding `BROKEN`."""
    checks = (_python, _packages, _extras, _known_bad_pairs, _devices, _backends, _ffmpeg, _caches, _dataset)
    for check in checks:
        try:
            yield from check()
        except Exception as error:  # any error is a finding for the user
            yield CheckResult(check.__name__.strip("_"), BROKEN, f"{type(error).__name__}: {error}")


def _python() -> Iterator[CheckResult]:
    """Yield versions of Python and the system."""
    detail = f"{platform.python_version()} on {platform.system()} {platform.machine()}, {os.cpu_count()} processors"
    yield CheckResult("python", OK, detail)


def _packages() -> Iterator[CheckResult]:
    """Yield the versions of `home-mjx`, `jaxlib` and each required dependency, sorted; `BROKEN` if not installed.

    They are not compared with the required versions.
    """
    required = [r for r in metadata.requires("home-mjx") or [] if "extra ==" not in r]
    for name in sorted({_project_name(r) for r in required} | {"home-mjx", "jaxlib"}):
        version = _version(name)
        if version is None:
            yield CheckResult(name, BROKEN, f"not installed. Try: pip install {name}")
        else:
            yield CheckResult(name, OK, version)


def _extras() -> Iterator[CheckResult]:
    """Yield the installed optional packages."""
    found = [f"{name} {version}" for name in OPTIONAL_PACKAGES if (version := _version(name))]
    yield CheckResult("extras", OK, ", ".join(found) or "none installed")


def _known_bad_pairs() -> Iterator[CheckResult]:
    """Yield a result for each known fault of the installed versions of JAX, and of Brax or Flax with it; else nothing.

    Flax that JAX is too old for is `BROKEN`; the others have a workaround, so they are a `NOTE`.
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
    """Yield one result per ray-casting backend (xla, cpu, cuda): usable here, or the reason why not."""
    from home_mjx.raycast_render.backends.registry import KERNEL

    yield CheckResult("backend xla", OK, "the reference, runs everywhere")
    problem = KERNEL.find_problem("cpu")
    detail = f"does not work: {problem}; `xla` is used instead, slower on a CPU" if problem else "compiled by Numba"
    yield CheckResult("backend cpu", NOTE if problem else OK, detail)
    yield _cuda_backend()


def _cuda_backend() -> CheckResult:
    """Return whether the `cuda` backend works; it is never `BROKEN`, since `xla` replaces it."""
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
    """Yield version and path of ffmpeg."""
    import imageio_ffmpeg

    program = imageio_ffmpeg.get_ffmpeg_exe()
    shown = subprocess.run([program, "-version"], capture_output=True, text=True, timeout=60, check=True).stdout
    yield CheckResult("ffmpeg", OK, f"{shown.split(' Copyright')[0]} at {program}")


def _caches() -> Iterator[CheckResult]:
    """Yield whether the cache folder is writable (else `BROKEN`), and JAX's compilation cache; `NOTE` if disabled.

    It enables that cache. A missing folder counts as its nearest parent that exists.
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
    """Yield the dataset that `$SUNCG_DATA_DIR` names; `NOTE` if it is not set, `BROKEN` if it cannot be read."""
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
