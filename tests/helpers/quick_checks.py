"""Annotations are checked once for each way in which a function is called, not at each call.

Whether they hold follows from the types, shapes and dtypes of what is handed over and given back: what has held once
for these holds again. Words count as well where a hint may be a `Literal`. Of a long list beartype looks at one item,
and so does this where no hint looks at all of them. Checking anew takes a quarter of all tests' time, and preparing the
checks of functions that nobody calls half of the time of an import.
"""

import enum
import functools
import inspect
import random
import sys
import threading
import types
from collections.abc import Callable, Collection, Iterator
from typing import Any

import jaxtyping

MOST = 1000  # ways of a function that are known; later ones are checked at each call
LONG = 32  # items of a list that are all looked into
CLOSE = ("Literal", "PyTree", "Annotated", "ForwardRef", "TypedDict")  # in hints that tell more than types and shapes
ARRAYS = ("numpy", "jax", "jaxlib")  # packages
PLAIN, ARRAY, TRACED, ITEMS, NAMED, WORD, MANY, SORT, UNKNOWN = range(9)
NOTHING = (None, Any, "None", "Any")  # hints that say nothing of what is handed over

_jaxtyped = jaxtyping.jaxtyped
_random = random.Random(0)  # of its own: the common one is seeded by what is tested
_sorts: dict[type, int] = {type(None): PLAIN, bool: PLAIN, int: PLAIN, float: PLAIN, str: WORD, bytes: PLAIN}
_functions: dict[types.CodeType, "_Function"] = {}
_running = threading.local()


class Unknown(Exception):
    """What holds for a value does not follow from a few facts."""


def install() -> None:
    """Before the package is imported, and before or after jaxtyping's own hook."""
    jaxtyping.jaxtyped = jaxtyped


def jaxtyped(*args: Any, **options: Any) -> Any:
    """As jaxtyping's own; functions are checked once for each way."""
    if args or set(options) != {"typechecker"}:
        return _jaxtyped(*args, **options)
    return functools.partial(_decorated, options["typechecker"])


def _decorated(checker: Any, target: Any) -> Any:
    odd = inspect.isgeneratorfunction, inspect.iscoroutinefunction, inspect.isasyncgenfunction
    if not isinstance(target, types.FunctionType) or any(is_odd(target) for is_odd in odd):
        return _jaxtyped(target, typechecker=checker)
    if all(hint in NOTHING for hint in target.__annotations__.values()):
        return target  # such as what Numba compiles, which older versions of jaxtyping wrap all the same
    # By its code: a function within another one is made anew whenever that one is called.
    known = _functions.get(target.__code__)
    if known is None:
        known = _functions[target.__code__] = _Function(checker)
        known.close = any(map(_is_close, target.__annotations__.values()))

    @functools.wraps(target)
    def checked(*args: Any, **options: Any) -> Any:
        if jaxtyping.config.jaxtyping_disable:
            return target(*args, **options)
        return known.call(target, args, options)

    return checked


class _Function:
    """What is known of the calls of a function."""

    def __init__(self, checker: Any) -> None:
        self.checker, self.full = checker, None
        self.close = True  # until its hints are known
        self.ways: dict[Any, set[Any]] = {}  # to kinds of results

    def call(self, target: Callable[..., Any], args: tuple[Any, ...], options: dict[str, Any]) -> Any:
        """The result, checked where it or the call is of a new kind."""
        try:
            way = kind(args, self.close), kind(options, self.close) if options else None
            results = self.ways.get(way)
        except (Unknown, TypeError):
            return self.check(target, args, options)
        if results is None:
            out = self.check(target, args, options)
            if len(self.ways) < MOST:
                self.ways[way] = set()
                self.note(self.ways[way], out)
            return out
        out = target(*args, **options)
        if not self.is_noted(results, out):
            self.check(lambda *_, **__: out, args, options)
            self.note(results, out)
        return out

    def check(self, target: Callable[..., Any], args: tuple[Any, ...], options: dict[str, Any]) -> Any:
        """The result, checked as jaxtyping does."""
        if self.full is None:
            self.full = self.around(target)
        stack = _running.__dict__.setdefault("stack", [])
        stack.append(target)
        try:
            return self.full(*args, **options)
        finally:
            stack.pop()

    def around(self, target: Callable[..., Any]) -> Callable[..., Any]:
        """The checks, around whatever is to be called; keeps nothing of what the function encloses."""

        running = _running

        def run(*args: Any, **options: Any) -> Any:
            return running.stack[-1](*args, **options)

        # With the function's names, by which hints that are strings are resolved.
        run = types.FunctionType(run.__code__, target.__globals__, closure=run.__closure__)
        for name in ("__module__", "__name__", "__qualname__", "__doc__"):
            setattr(run, name, getattr(target, name))
        run.__signature__ = inspect.signature(target)  # type: ignore[attr-defined]
        return _jaxtyped(run, typechecker=self.checker)

    def is_noted(self, results: set[Any], out: Any) -> bool:
        try:
            return kind(out, self.close) in results
        except (Unknown, TypeError):
            return False

    def note(self, results: set[Any], out: Any) -> None:
        try:
            if len(results) < MOST:
                results.add(kind(out, self.close))
        except (Unknown, TypeError):
            return


def kind(value: Any, close: bool) -> Any:
    """All of a value on which hints depend, or only what hints see that do not look closely; raises `Unknown`."""
    own = type(value)
    sort = _sorts.get(own)
    if sort is None:
        sort = _sorts[own] = _sort(own)
    if sort == PLAIN:
        return own
    if sort == TRACED:
        return sort, value.shape, value.dtype
    if sort == ARRAY:
        return own, value.shape, value.dtype
    if sort == WORD:
        return value if close else own
    if sort == SORT:
        return value
    if sort == UNKNOWN:
        raise Unknown
    if len(value) > LONG or sort == MANY:
        return _kind_of_many(own, value, close)
    if sort == NAMED:
        return own, tuple([(name, kind(item, close)) for name, item in value.items()])
    return own, tuple([kind(item, close) for item in value])


def _kind_of_many(own: type, value: Any, close: bool) -> Any:
    """By the item at which beartype looks: any of a list, the first of what has no order of its own."""
    if close:
        raise Unknown
    if not value:
        return own, 0
    if issubclass(own, tuple | list):
        return own, len(value) if issubclass(own, tuple) else LONG, kind(_random.choice(value), close)
    first = next(iter(value))
    return own, kind(first, close), kind(value[first], close) if own is dict else None


def _is_close(hint: Any) -> bool:
    return isinstance(hint, str) or any(name in repr(hint) for name in CLOSE)


def _is_of_jax(own: type) -> bool:
    """Arrays and all kinds of tracers, which no hint tells apart."""
    if not own.__module__.startswith("jax"):
        return False
    jax = sys.modules["jax"]
    return issubclass(own, (jax.Array, jax.core.Tracer))


def _sort(own: type) -> int:
    if issubclass(own, type):
        return SORT  # hints tell classes apart
    if issubclass(own, enum.Enum):
        return WORD
    if own.__module__.partition(".")[0] in ARRAYS and hasattr(own, "shape") and hasattr(own, "dtype"):
        # Of a class of ours, shapes may be properties that are checked in their turn.
        return TRACED if _is_of_jax(own) else ARRAY
    if own is dict:
        return NAMED
    if issubclass(own, tuple | list):
        return ITEMS
    if own in (set, frozenset, type({}.keys()), type({}.values())):
        return MANY
    if own is range or issubclass(own, Iterator):
        return PLAIN  # nobody looks into them
    return UNKNOWN if issubclass(own, Collection) else PLAIN
