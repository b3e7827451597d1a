"""Silent import of MJX, done before the rest of this package: without Warp, MJX prints a message to stdout."""

import contextlib
import io

with contextlib.redirect_stdout(io.StringIO()):
    from mujoco import mjx

__all__ = ["mjx"]
