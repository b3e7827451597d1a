"""Contact sheets take panels of any sizes."""

import numpy as np

from home_mjx.viewer.pictures.pictures import BACKGROUND, compose_sheet


def test_panels_of_different_sizes_lie_side_by_side():
    tall, flat = np.full((30, 16, 3), 200, np.uint8), np.full((10, 25, 3), 100, np.uint8)
    page = compose_sheet([[tall, flat], [flat]], gap=6)
    assert page.shape == (30 + 10 + 18, 16 + 25 + 18 + 1, 3)  # widths are even
    assert (page[6:36, 6:22] == 200).all()
    assert (page[6:16, 28:53] == 100).all()
    assert (page[42:52, 6:31] == 100).all()
    assert (page[:6] == BACKGROUND).all()
