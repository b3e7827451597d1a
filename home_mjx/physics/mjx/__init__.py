"""Reference physics: MJX on one template model, and the insertion of a house's numbers into it.

MJX is imported here first, silently: without Warp, it prints a message to stdout.
"""

import contextlib
import io

with contextlib.redirect_stdout(io.StringIO()):
    from mujoco import mjx as _mjx  # noqa: F401
