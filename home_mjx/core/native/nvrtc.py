"""Run-time compilation of CUDA C to PTX with the NVRTC library of `jax[cuda]`; results are cached on disk."""

import ctypes
import functools
import hashlib
import importlib.util
import logging
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from home_mjx.core.files import read_text, write_atomically
from home_mjx.core.paths import cache_folder
from home_mjx.errors import BackendError, DatasetError, install_hint

OPTIONS = ("--std=c++17",)
NO_DEFINES: Mapping[str, int] = {}
NAMES = ("libnvrtc.so.13", "libnvrtc.so.12", "libnvrtc.so")  # names for the system loader's search
DIGEST_HEADER = "// sha256 of the rest: "

log = logging.getLogger(__name__)


def compile_ptx(source: Path | Sequence[Path], capability: int, defines: Mapping[str, int] = NO_DEFINES) -> str:
    """Compile CUDA C to PTX, or load it from the cache if source, options, target and compiler are unchanged.

    Args:
        source: One or more files, which are concatenated; names of `extern "C"` functions are preserved.
        capability: Compute capability of the device, 90 for 9.0. An NVRTC that is too old for it compiles for the
            newest architecture that it supports, whose PTX the device also runs.
        defines: Integer macros by name.

    Raises:
        BackendError: NVRTC was not found, or it rejects the source.
    """
    library = find_library()
    files = [source] if isinstance(source, Path) else list(source)
    code, name = b"".join(file.read_bytes() for file in files), files[-1]
    target = f"compute_{_known(library, capability)}"
    options = (*OPTIONS, *(f"--define-macro={name}={value}" for name, value in defines.items()))
    key = hashlib.sha256(repr((code, target, options, version(library))).encode()).hexdigest()
    entry = cache_folder() / "kernels" / f"{name.stem}-{key[:24]}.ptx"
    kept = _read(entry)
    if kept is not None:
        return kept
    ptx = _compile(library, code, name.name, target, options)
    _keep(entry, ptx)
    return ptx


@functools.cache
def find_library() -> ctypes.CDLL:
    """Find and load NVRTC, from NVIDIA's Python packages or through the system's loader.

    Raises:
        BackendError: NVRTC was not found.
    """
    for name in (*_installed(), *NAMES):
        try:
            return _load(name)
        except OSError:
            continue
    raise BackendError("no NVRTC library found", hint=install_hint("cuda"))


def _load(name: Path | str) -> ctypes.CDLL:
    """Load NVRTC by path, after its built-in library, or by name through the system's loader."""
    if isinstance(name, Path):
        # NVRTC loads this library by name, and the loader does not search Python packages.
        for part in name.parent.glob("libnvrtc-builtins.so.*"):
            ctypes.CDLL(str(part), ctypes.RTLD_GLOBAL)
    return ctypes.CDLL(str(name))


def version(library: ctypes.CDLL) -> tuple[int, int]:
    """Return the major and minor version of NVRTC."""
    major, minor = ctypes.c_int(), ctypes.c_int()
    _check(library, library.nvrtcVersion(ctypes.byref(major), ctypes.byref(minor)))
    return major.value, minor.value


def _installed() -> Iterator[Path]:
    """Return paths of NVRTC in NVIDIA's Python packages (nvidia/cu13/lib, nvidia/cuda_nvrtc/lib), newest first."""
    package = importlib.util.find_spec("nvidia")
    folders = [Path(p) for p in package.submodule_search_locations or ()] if package else []
    found = [path for folder in folders for path in folder.glob("*/lib/libnvrtc.so.*")]
    return iter(sorted(found, key=lambda path: path.name, reverse=True))


def _known(library: ctypes.CDLL, capability: int) -> int:
    """Return NVRTC's newest architecture up to `capability` (90 for 9.0); `capability` itself if there is none."""
    count = ctypes.c_int()
    _check(library, library.nvrtcGetNumSupportedArchs(ctypes.byref(count)))
    known = (ctypes.c_int * count.value)()
    _check(library, library.nvrtcGetSupportedArchs(known))
    return max((arch for arch in known if arch <= capability), default=capability)


def _compile(library: ctypes.CDLL, code: bytes, name: str, target: str, options: Sequence[str]) -> str:
    """Compile CUDA C to PTX text; `name` is for messages, `target` such as "compute_90". Errors as of `compile_ptx`."""
    program = ctypes.c_void_p()
    create = library.nvrtcCreateProgram(ctypes.byref(program), code, name.encode(), 0, None, None)
    _check(library, create)
    try:
        given = [o.encode() for o in (f"--gpu-architecture={target}", *options)]
        status = library.nvrtcCompileProgram(program, len(given), (ctypes.c_char_p * len(given))(*given))
        if status:
            raise BackendError(f"NVRTC rejects {name}: {_text(library, program, 'ProgramLog')}")
        return _text(library, program, "PTX")
    finally:
        library.nvrtcDestroyProgram(ctypes.byref(program))


def _text(library: ctypes.CDLL, program: ctypes.c_void_p, what: str) -> str:
    """Return a text of a program, "PTX" or "ProgramLog"."""
    size = ctypes.c_size_t()
    _check(library, getattr(library, f"nvrtcGet{what}Size")(program, ctypes.byref(size)))
    text = ctypes.create_string_buffer(size.value)
    _check(library, getattr(library, f"nvrtcGet{what}")(program, text))
    return text.value.decode()


def _check(library: ctypes.CDLL, status: int) -> None:
    """Raise `BackendError` with NVRTC's message unless `status` is 0."""
    if status:
        library.nvrtcGetErrorString.restype = ctypes.c_char_p
        raise BackendError(f"NVRTC failed: {library.nvrtcGetErrorString(status).decode()}")


def _read(entry: Path) -> str | None:
    """Return the cached PTX; None if the entry is missing, or broken, which is logged."""
    try:
        head, _, ptx = read_text(entry).partition("\n")
    except FileNotFoundError:
        return None
    except DatasetError as error:
        log.warning("broken cache entry %s is rebuilt: %s", entry, error)
        return None
    if head != DIGEST_HEADER + _digest(ptx):
        log.warning("broken cache entry %s is rebuilt", entry)
        return None
    return ptx


def _keep(entry: Path, ptx: str) -> None:
    """Write PTX with its digest to the cache; failures are only logged."""
    try:
        with write_atomically(entry) as file:
            file.write(f"{DIGEST_HEADER}{_digest(ptx)}\n{ptx}".encode())
    except OSError as error:
        log.warning("compiled kernel is not cached: %s", error)


def _digest(text: str) -> str:
    """Return the SHA-256 of a text in hexadecimal."""
    return hashlib.sha256(text.encode()).hexdigest()
