"""Values over a floor plan as a picture."""

import numpy as np

from home_mjx.viewer.pictures.floor_map import SOUND_MAP_MARGIN, WALL_COLOUR, draw_sound_map
from home_mjx.viewer.pictures.pictures import BACKGROUND


def test_loud_is_bright_and_north_is_up():
    """Row 0 of the values, the south, is the lowest of the picture, and brighter than what is quieter."""
    values = np.array([[9.0, 9.0, np.nan], [1.0, 1.0, np.nan]])
    room = np.array([[True, True, True], [True, True, False]])
    picture = draw_sound_map(values, room, np.array([0.5, 2.5]), "G [dB]", 70)
    pixels = 10  # of a place
    plan = picture[-6 * pixels :, : 7 * pixels].reshape(6, pixels, 7, pixels, 3)[:, 1, :, 1]
    south, north = plan[-1 - SOUND_MAP_MARGIN, SOUND_MAP_MARGIN:], plan[-2 - SOUND_MAP_MARGIN, SOUND_MAP_MARGIN:]
    assert south[0].sum() > 2 * north[0].sum()
    assert tuple(north[2]) == BACKGROUND
    assert tuple(plan[-1 - SOUND_MAP_MARGIN, SOUND_MAP_MARGIN + 2]) in (WALL_COLOUR, (255, 255, 255))


def test_nothing_known_is_a_plan_all_the_same():
    picture = draw_sound_map(np.full((2, 2), np.nan), np.ones((2, 2), bool), np.zeros(2), "T30 [s]", 60)
    assert (picture == np.array(WALL_COLOUR)).all(axis=-1).any()
