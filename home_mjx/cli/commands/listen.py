"""Write the sound at a point of a house and its impulse response; print the room acoustic parameters."""

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from home_mjx.cli.houses import load_compiled_house
from home_mjx.cli.output import make_folder
from home_mjx.cli.parsing import number_type, parse_path
from home_mjx.cli.viewpoint import EYE_HEIGHT, Viewpoint, add_viewpoint_arguments, check_inside, place_head
from home_mjx.core.progress import ProgressPhase, show_compile
from home_mjx.core.variants import override_fields
from home_mjx.errors import ConfigError
from home_mjx.schema.compiled import BANDS
from home_mjx.viewer.pictures.storey_maps import draw_storey_maps

if TYPE_CHECKING:
    from home_mjx.audio_jax.parameters.room_survey import Survey
    from home_mjx.raycast_render.scene.types import Scene

PARAMETERS = (  # field of `RoomParameters`, title, format
    ("t20", "T20 [s]", ".2f"),
    ("t30", "T30 [s]", ".2f"),
    ("edt", "EDT [s]", ".2f"),
    ("c50", "C50 [dB]", ".1f"),
    ("c80", "C80 [dB]", ".1f"),
    ("d50", "D50", ".2f"),
    ("centre_time", "Ts [s]", ".3f"),
    ("drr", "DRR [dB]", ".1f"),
    ("strength", "G [dB]", ".1f"),
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the viewpoint of `add_viewpoint_arguments` and the options of `home-mjx listen`.

    `--source X Y Z` is a list of three numbers [m], None by default. `--clip`, by default `speech`, is the name of a
    clip, which `run` checks. `--late` is `traced` (default) or `baked`, and `--map` a flag. `--out` is the path of a
    folder (`sound`).
    """
    add_viewpoint_arguments(parser)
    parser.add_argument(
        "--source",
        type=number_type(),
        nargs=3,
        metavar=("X", "Y", "Z"),
        help="position of the source [m] (default: a goal in the house)",
    )
    parser.add_argument(
        "--clip", default="speech", help="name of the clip, such as radio, noise, bell (default: speech)"
    )
    parser.add_argument(
        "--late",
        choices=("traced", "baked"),
        default="traced",
        help="traced: late reverberation by ray tracing; baked: from a table computed once per house",
    )
    parser.add_argument("--map", action="store_true", help="write level and T30 over the floor plan as images")
    parser.add_argument("--out", type=parse_path, default=Path("sound"), help="folder for the files (default: sound)")


def run(args: argparse.Namespace) -> int:
    """Write `heard.wav`, `response.wav`, maps with `--map`; print paths and room acoustic parameters; return 0.

    `heard.wav` is the clip convolved with the impulse response. Without `--source`, the source is above the house's
    first goal, at eye height.

    Raises:
        ConfigError: The clip is unknown, or the source is in a wall or not above the floor of a room. Or as of
            `place_head`.
    """
    import jax
    import jax.numpy as jnp
    import numpy as np
    import scipy.signal

    from home_mjx.audio_jax.auralization.clips import clip_samples
    from home_mjx.audio_jax.base.endpoints import Listener, SoundSource, is_indoors
    from home_mjx.audio_jax.parameters.room_survey import SURVEY_CONFIG, survey_room
    from home_mjx.viewer.pictures.media import write_png, write_wav

    config = override_fields(SURVEY_CONFIG, {"late": args.late})
    clip = clip_samples(args.clip, config)
    make_folder(args.out)
    view = place_head(args)
    goal = np.asarray(view.bank.navigation.goal[0, 0]) + np.array([0, 0, EYE_HEIGHT], np.float32)
    source = goal if args.source is None else np.array(args.source, np.float32)
    check_inside(view.bank, source, "--source")
    if not bool(is_indoors(view.scene, jnp.asarray(source, jnp.float32))):
        given = f"--source {source[0]:g} {source[1]:g} {source[2]:g} is in a wall, or not above the floor of a room"
        raise ConfigError(given, hint="The result would be silent. `home-mjx render --top` shows the rooms.")
    scene = _bake_late_reverb(args, view) if args.late == "baked" else view.scene
    listener = Listener(jnp.asarray(view.position), jnp.asarray(view.head_quat))
    survey = jax.jit(survey_room, static_argnames="config")
    with show_compile("the survey of the room"):
        found = survey(scene, SoundSource(jnp.asarray(source)), listener, jax.random.key(0), config)
        response = np.asarray(found.response)
    heard = scipy.signal.fftconvolve(response, clip[None], axes=1)
    for name, samples in (("heard.wav", heard), ("response.wav", response)):
        write_wav(args.out / name, samples.astype(np.float32), config.sample_rate)
        sys.stdout.write(f"{args.out / name}\n")
    if args.map:
        with ProgressPhase("mapping level and T30 over the floor plan"):
            maps = draw_storey_maps(scene, source, config)
        for name, picture in maps.items():
            write_png(args.out / f"{name}.png", picture)
            sys.stdout.write(f"{args.out / name}.png\n")
    distance = np.linalg.norm(source - view.position)
    sys.stdout.write(f"source {np.round(source, 2)} m, head {np.round(view.position, 2)} m: {distance:.2f} m apart\n")
    rays = f"{SURVEY_CONFIG.traced.num_rays} rays, {SURVEY_CONFIG.traced.num_bounces} bounces"
    how = "baked late reverberation" if args.late == "baked" else rays
    sys.stdout.write(f"\n{format_parameters(found)}\n{how}\n")
    return 0


def _bake_late_reverb(args: argparse.Namespace, view: Viewpoint) -> "Scene":
    """Return the scene of `view` with baked late reverberation of its house, from the store or computed and stored."""
    from home_mjx.houses.bakes import add_bakes

    return view.scene.replace(bank=add_bakes(view.bank, [load_compiled_house(args)], "late_reverb"))


def format_parameters(survey: "Survey") -> str:
    """Format the parameters of a survey as text: one row each, one column per octave band; no newline at the end.

    The first row has the bands' centre frequencies [Hz]. The rows of `PARAMETERS`, IACC and LF follow.
    """
    rows = [("octave [Hz]", BANDS, "g")]
    rows += [(title, getattr(survey.parameters, name), form) for name, title, form in PARAMETERS]
    rows += [("IACC", survey.iacc, ".2f"), ("LF", survey.lateral_fraction, ".2f")]
    return "\n".join(title.ljust(12) + "".join(f"{float(v):8{form}}" for v in row) for title, row, form in rows)
