"""Options of the sound engine; all are static, that is fixed when a step is compiled."""

import math
from dataclasses import dataclass, field

from home_mjx.audio_jax.base.air import speed_of_sound
from home_mjx.audio_jax.base.delays import HALF_WIDTH
from home_mjx.audio_jax.base.options import (
    LATE_VARIANTS,
    MOTION_VARIANTS,
    RECEIVER_VARIANTS,
    Air,
    Ambisonics,
    Baked,
    Binaural,
    EarlyPaths,
    MicrophoneArray,
    Motion,
    NoLate,
    Omni,
    Traced,
    check_positive,
)
from home_mjx.core.checks import check_type
from home_mjx.core.variants import check_variants, variant_metadata
from home_mjx.errors import ConfigError
from home_mjx.schema.timing import MAX_STEP_SECONDS, Timing

TAIL_RINGING_SECONDS = 0.016  # [s], ringing of the tail's octave filters on each side
MIN_LEAD_SECONDS = 0.001  # [s], minimum of `max_lead_seconds`: covers the offset of any ear from the head centre


@dataclass(frozen=True)
class AudioConfig:
    """Options of the sound engine.

    Each part is a record whose options all have an effect. By name, as in `make("AudioNav-v0", receiver="omni")`, a
    word selects one of several records.

    Attributes:
        timing: Sample rate, and length of one sound frame. Octave bands above half the sample rate are silent.
        response_seconds: Length of impulse responses [s]; a whole number of bins.
        bin_seconds: Time bin of late energy [s].
        air: Temperature, humidity and pressure.
        early: Early paths: direct sound, diffraction and reflections.
        late: Late reverberation: `Traced` ("traced") by rays in every step, `Baked` ("baked") looked up in the bank, or
            `NoLate` ("none"). With `Baked`, `bin_seconds`, `air` and `early.reflection_order` have their defaults, with
            which banks are baked, and there are reflections.
        receiver: `Binaural` ("binaural"), `Omni` ("omni"), `MicrophoneArray` ("array") or `Ambisonics` ("ambisonics").
        motion: `Motion` (True): early paths move within a frame, and reverberation has a tail. None (False): whole
            responses are cross-faded.

    Raises:
        ConfigError: A value is invalid, or options contradict each other.

    Example:
        >>> AudioConfig().frame, AudioConfig(late=Traced(num_rays=96), receiver=Omni()).response_length
        (1600, 8000)
    """

    timing: Timing = field(default_factory=Timing)
    response_seconds: float = 0.5
    bin_seconds: float = 0.004
    air: Air = field(default_factory=Air)
    early: EarlyPaths = field(default_factory=EarlyPaths)
    late: Traced | Baked | NoLate = field(default_factory=Traced, metadata=variant_metadata(LATE_VARIANTS))
    receiver: Binaural | Omni | MicrophoneArray | Ambisonics = field(
        default_factory=Binaural, metadata=variant_metadata(RECEIVER_VARIANTS)
    )
    motion: Motion | None = field(default=None, metadata=variant_metadata(MOTION_VARIANTS))

    def __post_init__(self) -> None:
        for name, kind in (("timing", Timing), ("air", Air), ("early", EarlyPaths)):
            check_type(name, getattr(self, name), kind)
        check_variants(self)
        check_positive("response_seconds", self.response_seconds, MAX_STEP_SECONDS)
        check_positive("bin_seconds", self.bin_seconds, MAX_STEP_SECONDS)
        _check_whole("bin_seconds", self.bin_seconds * self.sample_rate, "samples")
        _check_whole("response_seconds", self.response_seconds / self.bin_seconds, "bins of `bin_seconds`")
        if self.motion is not None and self.num_bins < 2:
            raise ConfigError("with `motion` a response must have at least two bins: increase `response_seconds`")
        if self.bin_samples % 2:
            raise ConfigError(f"`bin_seconds` must hold an even number of samples, got {self.bin_samples}")
        if isinstance(self.late, Baked):
            self._check_baked()

    def _check_baked(self) -> None:
        """Raise `ConfigError` without reflections, or unless `bin_seconds`, `air`, `reflection_order` are defaults."""
        default, early = AudioConfig(), EarlyPaths().reflection_order
        for name, value, baked in (
            ("bin_seconds", self.bin_seconds, default.bin_seconds),
            ("reflection_order", self.early.reflection_order, early),
            ("air", self.air, default.air),
        ):
            if value != baked:
                hint = f"Use {baked}, or late=Traced()."
                raise ConfigError(f"late=Baked() does not support {name}={value}", hint=hint)
        if not self.early.num_reflections:
            hint = "Use at least 1: baked energies exclude first-order reflections, which early paths render."
            raise ConfigError("late=Baked() needs reflections", hint=hint)

    @property
    def traced(self) -> Traced:
        """Options of ray tracing; raises `ConfigError` if late reverberation is not traced."""
        if not isinstance(self.late, Traced):
            raise ConfigError(f"ray tracing needs late=Traced(...), got {self.late}")
        return self.late

    @property
    def binaural(self) -> Binaural:
        """Options of ears; raises `ConfigError` for other receivers."""
        if not isinstance(self.receiver, Binaural):
            raise ConfigError(f"expected receiver=Binaural(...), got {self.receiver}")
        return self.receiver

    @property
    def sample_rate(self) -> int:
        """Sample rate [Hz]."""
        return self.timing.sample_rate

    @property
    def num_channels(self) -> int:
        """Number of output channels: two ears, two equal ones of `Omni`, the microphones, or four of ambisonics."""
        return self.receiver.num_channels

    @property
    def num_late_channels(self) -> int:
        """Number of late energies per bin and octave: one per channel; for ambisonics 7, with three cross energies."""
        return self.num_channels + 3 * isinstance(self.receiver, Ambisonics)

    @property
    def receiver_radius(self) -> float:
        """Maximum distance of ears or microphones from the head centre [m]; 0.0875 for `Omni` and `Ambisonics`."""
        return self.receiver.radius

    @property
    def max_lead_seconds(self) -> float:
        """Maximum difference between arrival times at a channel and at the head centre [s]; at least 1 ms."""
        return max(MIN_LEAD_SECONDS, self.receiver_radius / self.speed_of_sound)

    @property
    def frame(self) -> int:
        """Samples per frame, the sound of one environment step."""
        return self.timing.frame

    @property
    def bin_samples(self) -> int:
        """Samples per time bin of late energy; an even number."""
        return round(self.bin_seconds * self.sample_rate)

    @property
    def num_bins(self) -> int:
        """Time bins of late energy in a response."""
        return round(self.response_seconds / self.bin_seconds)

    @property
    def response_length(self) -> int:
        """Samples of an impulse response, without the tail after it."""
        return self.num_bins * self.bin_samples

    @property
    def num_paths(self) -> int:
        """Number of early paths in a `ReceiverState`: direct, diffracted, reflected; at most `max_audible_paths`."""
        found = 1 + self.early.num_edges + self.early.num_reflections
        most = None if self.motion is None else self.motion.max_audible_paths
        return found if most is None else min(found, most)

    @property
    def tail_period(self) -> int:
        """Samples of a response's second half, rounded down to whole bins, which the tail repeats."""
        return self.num_bins // 2 * self.bin_samples

    @property
    def num_tail_repeats(self) -> int:
        """Repetitions of `tail_period` that cover `motion.tail_seconds`, rounded up; 0 without `motion` or period."""
        if self.motion is None or not self.tail_period:
            return 0
        return math.ceil(self.motion.tail_seconds * self.sample_rate / self.tail_period - 1e-9)

    @property
    def memory_length(self) -> int:
        """Samples of a source's past, with the current one, that affect an output sample: response, tail, ringing."""
        return self.response_length + self.num_tail_repeats * self.tail_period + self.num_tail_ringing

    @property
    def num_tail_ringing(self) -> int:
        """Samples by which octave filters of the tail ring on each side; 0 without a tail."""
        return round(TAIL_RINGING_SECONDS * self.sample_rate) if self.num_tail_repeats else 0

    @property
    def num_lookahead(self) -> int:
        """Samples of a source's future that delays read: two `HALF_WIDTH` and the maximum lead; 0 without `motion`."""
        if self.motion is None:
            return 0
        return 2 * HALF_WIDTH + math.ceil(self.max_lead_seconds * self.sample_rate)

    @property
    def speed_of_sound(self) -> float:
        """Speed of sound in `air` [m/s]."""
        return speed_of_sound(self.air.temperature)


def _check_whole(name: str, value: float, unit: str) -> None:
    """Raise `ConfigError` unless `value`, the number of `unit` in option `name`, is whole (within 1e-6), at least 1."""
    if abs(value - round(value)) > 1e-6 or round(value) < 1:
        raise ConfigError(
            f"`{name}` must hold a whole number of {unit}, got {value:g}",
            hint="Change it or `sample_rate` so that the division is exact.",
        )
