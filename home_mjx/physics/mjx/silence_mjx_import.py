"""Imports MJX before the rest of this package: without warp, MJX prints a message on stdout, into our output."""

import contextlib
import io

with contextlib.redirect_stdout(io.StringIO()):
    from mujoco import mjx

__all__ = ["mjx"]
