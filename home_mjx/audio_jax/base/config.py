"""Options of the sound engine; all are static, that is fixed when a step is compiled."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from home_mjx.audio_jax.base.air import speed_of_sound
from home_mjx.audio_jax.base.delays import HALF_WIDTH
from home_mjx.core.checks import check_known, check_number, check_type, shorten
from home_mjx.errors import ConfigError
from home_mjx.schema.compiled import BANDS
from home_mjx.schema.timing import MAX_STEP_SECONDS, Timing

RECEIVERS = ("binaural", "omni", "array", "ambisonics")
TWO_CHANNEL_RECEIVERS = ("binaural", "omni")  # receivers with a left and a right channel
DETECTORS = ("rain", "sphere")
EARLY_MODELS = ("physical", "home")
LATE_SOURCES = ("traced", "baked", "none")
# Late reverberation is baked with the default values of these options.
BAKED_OPTIONS = ("bin_seconds", "reflection_order", "temperature", "humidity", "pressure")
TAIL_RINGING_SECONDS = 0.016  # [s], ringing of the tail's octave filters on each side
MIN_LEAD_SECONDS = (
    0.001  # [s], minimum of `max_lead_seconds`: covers the arrival-time offset of any ear from the head centre
)
MAX_MICROPHONES = 32
MAX_MICROPHONE_DISTANCE = 1.0  # [m], maximum distance of a microphone from the head centre


@dataclass(frozen=True)
class AudioConfig:
    """Options of the sound engine.

    Attributes:
        timing: Sample rate, and length of one sound frame. Octave bands above half the sample rate are silent.
        response_seconds: Length of impulse responses [s]; a whole number of bins.
        num_rays: Rays per source that trace the late part.
        num_bounces: Reflections traced per ray; later energy is extrapolated.
        num_reflections: Maximum number of reflections rendered as paths, the shortest first.
        reflection_order: Maximum order of rendered reflections, 1 to 3. At order 1 only walls, floors and ceilings
            reflect; from order 2 on, faces of furniture, doors and bodies do as well.
        num_edges: Edges of walls, doorways and furniture that diffract direct sound, those with the shortest detour.
            0 disables diffraction; objects then transmit sound by their material's transmission coefficient.
        max_crossings: Maximum number of surfaces that direct sound crosses; it is silent beyond them.
        bin_seconds: Time bin of the energy histogram [s].
        detector: Estimator of late specular energy. "rain" emits it diffusely from every hit. Its variance is low with
            few rays, and decay times are within a few per cent for scattering of at least 0.1 (-6 % at 0). "sphere"
            counts specular rays through a sphere: unbiased at any scattering, but needs thousands of rays.
        octave_rays: Whether each ray carries one octave and scatters by that octave's coefficient. `num_rays` is then a
            multiple of 7 and counts the rays of all octaves. False: all octaves share one direction, drawn by their
            mean scattering, which is biased where scattering rises with frequency.
        detector_radius: Radius of that sphere, and minimum distance between a hit and the source in "rain" [m].
        receiver: "binaural": two ears on a rigid sphere. "omni": the same free-field pressure in both channels.
            "array": `microphones`. "ambisonics": four first-order channels, see `ambisonic_gains`.
        microphones: With the receiver "array", positions in the head frame: +x right, +y up, -z ahead [m].
        head_radius: [m].
        ear_angle: Angle between nose and ears [degrees].
        pinna: Whether ears have pinna echoes, which distinguish up from down and front from back, see `pinna_delays`;
            only with the receiver "binaural".
        temperature: [degrees Celsius].
        humidity: Relative humidity [%].
        pressure: [kPa].
        late: Source of late reverberation. "traced": rays in every step. "baked": looked up in the bank, see
            `add_bakes`. `num_rays`, `num_bounces`, `octave_rays` and the detector are then ignored, and
            `bin_seconds`, `reflection_order` and the air must have their defaults, with which the bank was baked.
            "none": no late reverberation.
        early: Model of early paths. "physical": this engine's. "home": that of HoME (2017), for comparison, see
            `audio_preset("home")`. It has specular paths up to `reflection_order`, boxes for objects, whole-sample
            delays and its own air table; no diffraction, transmission or late reverberation.
        motion: Whether early paths move within a frame (Doppler effect at every frequency) and reverberation continues
            for `tail_seconds`. False: whole responses are cross-faded, see `convolve_clip_frame`.
        max_audible_paths: With `motion`, maximum number of audible early paths: the direct path and the strongest others. The
            cost of a frame grows with it; of 21 candidates in houses at most 7 are audible. None: all.
        tail_seconds: With `motion`, reverberation beyond `response_seconds` [s], each octave at its last decay rate;
            rounded up to half responses.

    Raises:
        ConfigError: If a value is invalid, or options contradict each other.

    Example:
        >>> AudioConfig().frame, AudioConfig().response_length
        (1600, 8000)
    """

    timing: Timing = field(default_factory=Timing)
    response_seconds: float = 0.5
    num_rays: int = 48
    num_bounces: int = 24
    num_reflections: int = 8
    reflection_order: int = 1
    num_edges: int = 0
    max_crossings: int = 32
    bin_seconds: float = 0.004
    octave_rays: bool = False
    detector: str = "rain"
    detector_radius: float = 0.5
    receiver: str = "binaural"
    microphones: Sequence[Any] = ()
    head_radius: float = 0.0875
    ear_angle: float = 90.0
    pinna: bool = False
    temperature: float = 20.0
    humidity: float = 50.0
    pressure: float = 101.325
    late: str = "traced"
    early: str = "physical"
    motion: bool = False
    max_audible_paths: int | None = None
    tail_seconds: float = 1.5

    def __post_init__(self) -> None:
        check_type("timing", self.timing, Timing)
        check_known("receiver", [self.receiver], RECEIVERS)
        check_known("detector", [self.detector], DETECTORS)
        check_known("late", [self.late], LATE_SOURCES)
        check_known("early", [self.early], EARLY_MODELS)
        for name in ("num_rays", "num_bounces", "max_crossings"):
            check_number(name, getattr(self, name), 1, integer=True)
        for name in ("num_reflections", "num_edges"):
            check_number(name, getattr(self, name), 0, integer=True)
        check_number("reflection_order", self.reflection_order, 1, 3, integer=True)
        for name in ("temperature", "humidity", "ear_angle"):
            check_number(name, getattr(self, name))
        check_type("motion", self.motion, bool)
        check_type("pinna", self.pinna, bool)
        check_type("octave_rays", self.octave_rays, bool)
        if self.octave_rays and self.num_rays % len(BANDS):
            raise ConfigError(f"`octave_rays` needs `num_rays` to be a multiple of {len(BANDS)}, got {self.num_rays}")
        if self.pinna and self.receiver != "binaural":
            raise ConfigError(f'`pinna` needs receiver="binaural", got {self.receiver!r}')
        if self.max_audible_paths is not None:
            check_number("max_audible_paths", self.max_audible_paths, 1, integer=True)
        check_number("tail_seconds", self.tail_seconds, 0.0)
        for name in ("response_seconds", "bin_seconds", "detector_radius", "head_radius", "pressure"):
            check_number(name, getattr(self, name))
            if name.endswith("_seconds"):
                check_number(name, getattr(self, name), maximum=MAX_STEP_SECONDS)
            if getattr(self, name) <= 0:
                raise ConfigError(f"`{name}` must be positive, got {getattr(self, name)}")
        if not 0 <= self.humidity <= 100 or not -70 <= self.temperature <= 70:
            raise ConfigError(
                f"expected a humidity of 0..100 % and a temperature of -70..70 °C, "
                f"got {self.humidity} and {self.temperature}"
            )
        _check_whole("bin_seconds", self.bin_seconds * self.sample_rate, "samples")
        _check_whole("response_seconds", self.response_seconds / self.bin_seconds, "bins of `bin_seconds`")
        if self.motion and self.num_bins < 2:
            raise ConfigError("with `motion` a response must have at least two bins: increase `response_seconds`")
        if self.bin_samples % 2:
            raise ConfigError(f"`bin_seconds` must hold an even number of samples, got {self.bin_samples}")
        if self.late == "baked":
            self._check_baked()
        self._check_microphones()
        if self.early == "home":
            self._check_home()

    def _check_home(self) -> None:
        for name, value in {"late": "none", "num_edges": 0, "motion": False}.items():
            if getattr(self, name) != value:
                hint = 'Use audio_preset("home"), which sets all options of that mode.'
                raise ConfigError(f"early='home' needs {name}={value!r}, got {getattr(self, name)!r}", hint=hint)

    def _check_microphones(self) -> None:
        if isinstance(self.microphones, str) or not isinstance(self.microphones, Sequence):
            raise ConfigError(f"`microphones` must be a tuple of positions, got {shorten(self.microphones)}")
        if (self.receiver == "array") != bool(self.microphones):
            hint = 'Set both, for example receiver="array", microphones=((0, 0, 0),).'
            raise ConfigError('`microphones` and receiver="array" require each other', hint=hint)
        if len(self.microphones) > MAX_MICROPHONES:
            raise ConfigError(f"expected at most {MAX_MICROPHONES} `microphones`, got {len(self.microphones)}")
        for place in self.microphones:
            if isinstance(place, str) or not isinstance(place, Sequence) or len(place) != 3:
                raise ConfigError(f"each of `microphones` needs three numbers, got {shorten(place)}")
            for number in place:
                check_number("microphones", number)
        # Option files yield lists; the configuration must be hashable.
        object.__setattr__(self, "microphones", tuple(tuple(float(x) for x in place) for place in self.microphones))
        if self.receiver_radius > MAX_MICROPHONE_DISTANCE:
            hint = "Late reverberation differs farther apart: use a separate `Listener` there."
            raise ConfigError(f"`microphones` must be within {MAX_MICROPHONE_DISTANCE} m of the head centre", hint=hint)

    def _check_baked(self) -> None:
        for name in BAKED_OPTIONS:
            value = getattr(AudioConfig, name)  # its default
            if getattr(self, name) != value:
                hint = f"Leave it at {value}, or use late='traced'."
                raise ConfigError(f"late='baked' does not support {name}={getattr(self, name)}", hint=hint)
        if not self.num_reflections:
            hint = "Use at least 1: baked energies exclude first-order reflections, which early paths render."
            raise ConfigError("late='baked' needs reflections", hint=hint)

    @property
    def sample_rate(self) -> int:
        """Sample rate [Hz]."""
        return self.timing.sample_rate

    @property
    def num_channels(self) -> int:
        """Number of output channels: two ears, the microphones, or four of ambisonics."""
        return {"array": len(self.microphones), "ambisonics": 4}.get(self.receiver, 2)

    @property
    def num_late_channels(self) -> int:
        """Number of late energies per bin: one per channel, and three intensities of ambisonics, see `late_channel_gains`."""
        return self.num_channels + 3 * (self.receiver == "ambisonics")

    @property
    def ray_groups(self) -> int:
        """Number of independent ray groups: one, or one per octave with `octave_rays`."""
        return len(BANDS) if self.octave_rays else 1

    @property
    def receiver_radius(self) -> float:
        """Maximum distance of ears or microphones from the head centre [m]."""
        return max((math.hypot(*place) for place in self.microphones), default=self.head_radius)

    @property
    def max_lead_seconds(self) -> float:
        """Maximum difference between arrival times at a channel and at the head centre, at least `MIN_LEAD_SECONDS` [s]."""
        return max(MIN_LEAD_SECONDS, self.receiver_radius / self.speed_of_sound)

    @property
    def frame(self) -> int:
        """Samples per frame."""
        return self.timing.frame

    @property
    def bin_samples(self) -> int:
        """Samples per bin of the histogram."""
        return round(self.bin_seconds * self.sample_rate)

    @property
    def num_bins(self) -> int:
        """Bins of the histogram."""
        return round(self.response_seconds / self.bin_seconds)

    @property
    def response_length(self) -> int:
        """Samples of an impulse response."""
        return self.num_bins * self.bin_samples

    @property
    def num_paths(self) -> int:
        """Number of early paths with `motion`, including the direct one."""
        found = 1 + self.num_edges + self.num_reflections
        return found if self.max_audible_paths is None else min(found, self.max_audible_paths)

    @property
    def tail_period(self) -> int:
        """Samples of a response's second half, which the tail repeats."""
        return self.num_bins // 2 * self.bin_samples

    @property
    def num_tail_repeats(self) -> int:
        """Number of these repetitions; 0 without `motion`."""
        long = self.motion and self.tail_period > 0
        return math.ceil(self.tail_seconds * self.sample_rate / self.tail_period - 1e-9) if long else 0

    @property
    def memory_length(self) -> int:
        """Samples of a source's past, including the current one, that contribute to the current output sample."""
        return self.response_length + self.num_tail_repeats * self.tail_period + self.num_tail_ringing

    @property
    def num_tail_ringing(self) -> int:
        """Samples by which octave filters of the tail ring on each side; 0 without a tail."""
        return round(TAIL_RINGING_SECONDS * self.sample_rate) if self.num_tail_repeats else 0

    @property
    def num_lookahead(self) -> int:
        """Samples of a source's future that band-limited delays read; 0 without `motion`."""
        return 2 * HALF_WIDTH + math.ceil(self.max_lead_seconds * self.sample_rate) if self.motion else 0

    @property
    def speed_of_sound(self) -> float:
        """Speed of sound at `temperature` [m/s]."""
        return speed_of_sound(self.temperature)


def _check_whole(name: str, value: float, unit: str) -> None:
    if abs(value - round(value)) > 1e-6 or round(value) < 1:
        raise ConfigError(
            f"`{name}` must hold a whole number of {unit}, got {value:g}",
            hint="Change it or `sample_rate` so that the division is exact.",
        )
