"""Steps that must lose nothing: most tests walk where every contact has its slot and every response its room."""

from collections.abc import Callable
from typing import Any

from home_mjx.tasks import check_status


def checked(function: Callable[..., Any], ignore: int = 0) -> Callable[..., Any]:
    """A compiled `reset` or `step` that raises `StatusError` for the flags of its state, but for `ignore`."""

    def call(*args: Any) -> Any:
        state = function(*args)
        check_status(state, ignore)
        return state

    return call
