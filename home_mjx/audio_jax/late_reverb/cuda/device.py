"""One house on a GPU: the arrays that rays read, and visibility between points."""

import threading
import weakref
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Bool, Float

from home_mjx.audio_jax.late_reverb.cuda.kernels import BLOCK, LANES, open_gpu
from home_mjx.audio_jax.late_reverb.trace.house_rays import HouseRays
from home_mjx.bank.bank import HouseBank
from home_mjx.bank.records.gpu_geometry import HALF_SIZE_FACTOR, gpu_geometry
from home_mjx.core.native.cuda_driver import CudaStream, pack_words
from home_mjx.schema.compiled import BANDS

MAX_SEGMENTS = 1 << 20  # of one test of visibility
HOUSE_WORDS = 12  # words of `Flights` in flight.cu that describe the geometry, before those of surfaces

_lock = threading.Lock()
_held: list[tuple[Any, tuple[np.ndarray, np.ndarray, np.ndarray]]] = []  # the last bank, weakly, and its arrays


@dataclass(frozen=True)
class DeviceHouse:
    """One house of a bank in its initial state, with all doors wide open, on a GPU; see `HouseRays`.

    Attributes:
        stream: Queue of the GPU's work.
        fields: First arguments of `Flights` in flight.cu, up to the materials' coefficients.
    """

    stream: CudaStream
    fields: tuple[Any, ...]

    @classmethod
    def from_rays(
        cls, rays: HouseRays, bank: HouseBank, index: int, open_stream: Callable[[], CudaStream] | None = None
    ) -> "DeviceHouse":
        """Copy the arrays of house `index` of a bank to a GPU.

        Args:
            rays: The house on the host.
            bank: The bank.
            index: Index of the house.
            open_stream: Opens the queue of work; None: one of the GPU.

        Raises:
            BackendError: There is no GPU, or it fails; so do the methods.
        """
        stream = (open_stream or open_gpu)()
        node, triangle, fixed = _bank_arrays(bank)
        records, boxes = _pack_moving(rays)
        sizes = rays.sizes
        numbers = (_root_of(rays, index), len(records), len(node), len(triangle), sizes.materials, fixed.shape[1])
        _, _, inverse, material, *acoustic = rays.surfaces
        coefficients = (np.pad(x[:, : len(BANDS)], ((0, 0), (0, LANES - len(BANDS)))) for x in acoustic)
        arrays = node, triangle, rays.arrays[10].astype(np.int32), fixed[index], records, boxes
        surfaces = inverse.astype(np.float32), material.astype(np.int32), *coefficients
        fields = *map(stream.upload, arrays), *map(int, numbers), *map(stream.upload, surfaces)
        return cls(stream, fields)

    def occluded(self, start: Float[np.ndarray, "n 3"], end: Float[np.ndarray, "n 3"]) -> Bool[np.ndarray, " n"]:
        """Return for each pair of points [m] whether a surface that blocks sound is between them."""
        start = np.ascontiguousarray(start, np.float32)
        way = np.ascontiguousarray(end - start, np.float32)
        cuts = range(0, len(start), MAX_SEGMENTS)
        parts = [self._occluded(start[i : i + MAX_SEGMENTS], way[i : i + MAX_SEGMENTS]) for i in cuts]
        return np.concatenate([*parts, np.zeros(0, bool)])

    def _occluded(self, start: Float[np.ndarray, "n 3"], way: Float[np.ndarray, "n 3"]) -> Bool[np.ndarray, " n"]:
        """Return whether a surface that blocks sound is between `start` and `start + way`, in one launch."""
        count, found = len(start), self.stream.empty((len(start),), np.uint8)
        given = self.stream.upload(start), self.stream.upload(way)
        words = pack_words([*self.fields[:HOUSE_WORDS], *given, found, count])
        self.stream.launch("test_segments", -(-count // BLOCK), BLOCK, words)
        return self.stream.download(found) > 0


def _bank_arrays(bank: HouseBank) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the nodes, triangles and static instances of a bank; the last bank's are kept for its next house."""
    key = bank.geometry.node_box
    with _lock:
        if not _held or _held[0][0]() is not key:
            gpu = bank.geometry.gpu if bank.geometry.gpu is not None else gpu_geometry(bank.geometry)
            _held[:] = [(weakref.ref(key), (np.asarray(gpu.node), np.asarray(gpu.triangle), np.asarray(gpu.instance)))]
        return _held[0][1]


def _root_of(rays: HouseRays, index: int) -> int:
    """Return the root of the tree over the static instances of a house."""
    return int(rays.arrays[5][index])


def _pack_moving(rays: HouseRays) -> tuple[Float[np.ndarray, "d 16"], Float[np.ndarray, "d 6"]]:
    """Return records of the moving instances, as of `pack_instances`, and the centres and half sizes of boxes."""
    model_root, (instance, model, inverse, box, object_id, material) = rays.arrays[4], rays.arrays[14:20]
    notes = np.stack([model_root[model], instance, object_id, material], axis=1).astype(np.int32)
    records = np.concatenate([inverse.reshape(-1, 12), notes.view(np.float32)], axis=1).astype(np.float32)
    low, high = box[:, 0].astype(np.float32), box[:, 1].astype(np.float32)
    center = low / 2 + high / 2
    half = np.maximum(high - center, center - low) * np.float32(HALF_SIZE_FACTOR)
    return records, np.concatenate([center, half], axis=1)
