"""Enumerations whose unknown members raise an error with the closest known name."""

from enum import EnumMeta, IntEnum
from typing import TYPE_CHECKING, Any, NoReturn

from home_mjx.errors import UnknownMemberError, did_you_mean


class _SuggestingMeta(EnumMeta):
    if not TYPE_CHECKING:  # type checkers would otherwise accept any name

        def __getattr__(cls, name: str) -> NoReturn:
            if name.startswith("_"):  # Python's own look-ups, which expect a bare error
                raise AttributeError(name)
            cls._raise_unknown(name)

        def __getitem__(cls, name: str) -> Any:
            if name not in cls.__members__:
                cls._raise_unknown(name)
            return super().__getitem__(name)

        def _raise_unknown(cls, name: str) -> NoReturn:
            """Raise `UnknownMemberError` with the closest member name; matching ignores lower case."""
            alike = name.upper() if isinstance(name, str) else name
            hint = did_you_mean(alike, cls.__members__)
            raise UnknownMemberError(f"{cls.__name__} has no member `{name}`", hint=hint)


class NamedIntEnum(IntEnum, metaclass=_SuggestingMeta):
    """Integer enumeration whose unknown members raise `UnknownMemberError`, which is an `AttributeError` as well.

    Example:
        >>> class Side(NamedIntEnum):
        ...     LEFT = 0
        ...     RIGHT = 1
        >>> Side.LEFT, Side["RIGHT"]
        (<Side.LEFT: 0>, <Side.RIGHT: 1>)
        >>> Side.LEFFT  # doctest: +ELLIPSIS
        Traceback (most recent call last):
        ...
        home_mjx.errors.UnknownMemberError: Side has no member `LEFFT`. Did you mean `LEFT`? Known: LEFT, RIGHT...
    """
