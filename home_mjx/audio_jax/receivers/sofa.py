"""Heads from SOFA files (AES69), convention SimpleFreeFieldHRIR; requires the extra `sofa`."""

import logging
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.endpoints import MeasuredHead
from home_mjx.audio_jax.receivers.measured_hrtf import make_measured_head
from home_mjx.errors import ConfigError, DatasetError, MissingFileError, install_hint

CONVENTION = "SimpleFreeFieldHRIR"
MIN_RELATIVE_DISTANCE = 0.9  # minimum distance re the farthest source; nearer ones are another set of measurements
SUFFIX = ".sofa"

log = logging.getLogger(__name__)


class HeadMeasurements(NamedTuple):
    """Impulse responses of a SOFA file: m directions, left and right ear."""

    direction: Float[np.ndarray, "m 3"]  # unit vectors in the frame of the head: +x right, +y up, looking along -z
    response: Float[np.ndarray, "m 2 n"]
    rate: float  # [Hz]
    delay: Float[np.ndarray, "m 2"]  # [s]


def read_head(path: str | Path, config: AudioConfig, phase: str = "minimum", level: str = "file") -> MeasuredHead:
    """Read a head from a SOFA file of free-field responses of two ears, see `make_measured_head`.

    If the file has several source distances, only sources at 90 % or more of the largest are used.

    Args:
        path: The file; its name ends in `.sofa`.
        config: Options of the simulation that will use the head.
        phase: "minimum" or "measured", see `make_measured_head`.
        level: "file" or "sphere", see `make_measured_head`. Use "sphere" for files that are not relative to the free
            field, as many are.

    Raises:
        MissingFileError: The file does not exist.
        DatasetError: The file is not a SOFA file, follows another convention, or has unusable data.
        ConfigError: An option is unknown, or the extra `sofa` is not installed.

    Example:
        >>> head = read_head("kemar.sofa", config, level="sphere")  # doctest: +SKIP
        >>> heard = jax.jit(impulse_response, static_argnums=4)  # doctest: +SKIP
        >>> heard(scene, source, Listener(ears, quat, head=head), jax.random.key(0), config)  # doctest: +SKIP
    """
    found = read_measurements(path)
    try:
        return make_measured_head(found.direction, found.response, found.rate, config, found.delay, phase, level)
    except ConfigError as error:
        if type(error) is not ConfigError:  # an unknown option value, not a fault of the file
            raise
        raise DatasetError(error.message, file=path, element="Data.IR", hint=error.hint) from error


def read_measurements(path: str | Path) -> HeadMeasurements:
    """Read a SOFA file's responses to its sources at 90 % or more of the largest distance; errors as in `read_head`."""
    path = Path(path)
    sofa = _open(path)
    response = _read_numbers(sofa, "Data_IR", path)
    if response.ndim != 3 or response.shape[1] != 2 or 0 in response.shape:
        raise DatasetError(f"expected responses (m, 2, n), got {response.shape}", file=path, element="Data.IR")
    rate = _read_numbers(sofa, "Data_SamplingRate", path)
    if rate.size != 1 or not rate.item() > 0:
        raise DatasetError(f"expected one positive rate, got {rate}", file=path, element="Data.SamplingRate")
    count = response.shape[0]
    late = _broadcast_rows(_read_numbers(sofa, "Data_Delay", path), (count, 2), path, "Data.Delay") / rate.item()
    order = _ear_order(sofa, path)
    away = _source_vectors(sofa, count, path)
    distance = np.linalg.norm(away, axis=1)
    if not distance.min() > 0:
        raise DatasetError("a source is at the head centre", file=path, element="SourcePosition")
    kept = distance >= MIN_RELATIVE_DISTANCE * distance.max()
    if not kept.all():
        log.info("%s: using the %d farthest of %d directions", path, kept.sum(), count)
    unit = away[kept] / distance[kept, None]
    return HeadMeasurements(unit, response[kept][:, order], rate.item(), late[kept][:, order])


def _open(path: Path) -> Any:
    """Open a SOFA file of `CONVENTION`; errors as in `read_head`."""
    try:
        import sofar
    except ImportError as error:
        raise ConfigError("reading SOFA files needs `sofar`", hint=install_hint("sofa")) from error
    if not path.is_file():
        raise MissingFileError("there is no such file", file=path)
    if path.suffix != SUFFIX:  # sofar would append the suffix and read another file
        raise DatasetError(f"expected a name that ends in {SUFFIX}", file=path)
    try:
        # Many published files break minor rules, so sofar does not verify them; all fields used are validated here.
        read: Any = sofar.read_sofa
        sofa = read(str(path), verify=False, verbose=False)
    except (OSError, ValueError, AttributeError, KeyError, TypeError, IndexError, RuntimeError) as error:
        raise DatasetError(f"the file cannot be read as SOFA: {error}", file=path) from error
    if sofa.GLOBAL_SOFAConventions != CONVENTION:
        text = f"expected the convention {CONVENTION}, got {sofa.GLOBAL_SOFAConventions!r}"
        raise DatasetError(text, file=path, element="GLOBAL:SOFAConventions")
    return sofa


def _read_numbers(sofa: Any, name: str, path: Path) -> Float[np.ndarray, "..."]:
    """Return a field of a file; raise `DatasetError` unless it consists of finite numbers."""
    element = name.replace("_", ".") if name.startswith("Data") else name
    try:
        values = np.asarray(getattr(sofa, name), float)
    except (AttributeError, TypeError, ValueError) as error:
        raise DatasetError("expected numbers, got none", file=path, element=element) from error
    if not np.isfinite(values).all():
        raise DatasetError("some numbers are not finite", file=path, element=element)
    return values


def _broadcast_rows(values: np.ndarray, shape: tuple[int, ...], path: Path, element: str) -> np.ndarray:
    """Broadcast one row to `shape`, or return the given rows; raise `DatasetError` for other shapes."""
    try:
        return np.broadcast_to(np.atleast_2d(values), shape)
    except ValueError as error:
        raise DatasetError(
            f"expected {shape} or (1, {shape[1]}) numbers, got {values.shape}", file=path, element=element
        ) from error


def _ear_order(sofa: Any, path: Path) -> list[int]:
    """Return the file's receiver indices of left, right ear; raise `DatasetError` if neither is farther left (+y)."""
    ears = _read_numbers(sofa, "ReceiverPosition", path)
    ears = ears[..., 0] if ears.ndim == 3 else ears
    places = _cartesian(_broadcast_rows(ears, (2, 3), path, "ReceiverPosition"), sofa, "ReceiverPosition", path)
    if places[0, 1] == places[1, 1]:
        raise DatasetError("neither ear is to the left of the other", file=path, element="ReceiverPosition")
    return [0, 1] if places[0, 1] > places[1, 1] else [1, 0]


def _source_vectors(sofa: Any, count: int, path: Path) -> Float[np.ndarray, "m 3"]:
    """Compute vectors from head centre to sources [m], in the head frame; `DatasetError` without valid view and up."""

    def vectors(name: str, kind: str) -> np.ndarray:
        """Return a field, cartesian, one row per source; `kind`: field with its coordinate type."""
        return _cartesian(_broadcast_rows(_read_numbers(sofa, name, path), (count, 3), path, name), sofa, kind, path)

    away = vectors("SourcePosition", "SourcePosition") - vectors("ListenerPosition", "ListenerPosition")
    ahead, up = vectors("ListenerView", "ListenerView"), vectors("ListenerUp", "ListenerView")
    right = np.cross(ahead, up)
    if not np.linalg.norm(right, axis=1).min() > 1e-6:
        raise DatasetError("the up vector is zero or parallel to the view direction", file=path, element="ListenerUp")
    above = np.cross(right, ahead)
    axes = np.stack([x / np.linalg.norm(x, axis=1, keepdims=True) for x in (right, above, -ahead)], axis=1)
    return np.einsum("mij,mj->mi", axes, away)


def _cartesian(values: np.ndarray, sofa: Any, name: str, path: Path) -> np.ndarray:
    """Return cartesian coordinates (x ahead, y left, z up), converted if the file declares spherical ones [degrees, m].

    Raise `DatasetError` for other types.
    """
    kind = getattr(sofa, f"{name}_Type", None)
    if kind == "cartesian":
        return values
    if kind != "spherical":
        text = f"expected the coordinates cartesian or spherical, got {kind!r}"
        raise DatasetError(text, file=path, element=f"{name}:Type")
    azimuth, elevation = np.radians(values[:, 0]), np.radians(values[:, 1])
    ring = np.cos(elevation)
    return values[:, 2:] * np.stack([ring * np.cos(azimuth), ring * np.sin(azimuth), np.sin(elevation)], axis=1)
