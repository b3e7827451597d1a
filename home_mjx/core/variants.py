"""Fields that hold one of several option records, and changes of nested records by name.

A field such as `late: Traced | Baked | NoLate` lists its records by word. Constructors take records only. Options by
name, as of `home_mjx.make`, may select a record by its word, and change fields of the selected one.
"""

import dataclasses
from collections import defaultdict
from collections.abc import Hashable, Mapping
from types import MappingProxyType
from typing import Any

from home_mjx.core.checks import check_type, shorten
from home_mjx.errors import ConfigError, UnknownNameError, did_you_mean

KEY = "variants"  # in the metadata of a field
Variants = Mapping[Any, type | None]  # record types by word; None: the value None


def variant_metadata(variants: Variants) -> dict[str, Any]:
    """Return the metadata of a dataclass field that holds one of several frozen records.

    `variants` has the record types by the word that selects them; None stands for the value None.
    """
    return {KEY: MappingProxyType(dict(variants))}


def variants_of(record: Any, name: str) -> Variants:
    """Return the variants by word of field `name` of a record (instance or class); empty if it is an ordinary field."""
    return record.__dataclass_fields__[name].metadata.get(KEY, {})


def check_variants(record: Any) -> None:
    """Raise `ConfigError` unless each field of an instance that has variants holds one of their record types.

    None is valid only if it is a variant; a word is rejected.
    """
    for field in dataclasses.fields(record):
        kinds, value = field.metadata.get(KEY, {}), getattr(record, field.name)
        if kinds and not (isinstance(value, _types(kinds)) or (value is None and None in kinds.values())):
            names = " or ".join("None" if kind is None else f"{kind.__name__}(...)" for kind in kinds.values())
            raise ConfigError(f"`{field.name}` must be {names}, got {shorten(value)}")


def nested_names(record: Any, name: str) -> tuple[str, ...]:
    """Return the distinct field names of the record in field `name` of an instance; () if it holds none.

    If the field has variants, the names of all of them are returned, whatever its value.
    """
    value, kinds = getattr(record, name), variants_of(record, name)
    found: tuple[Any, ...] = _types(kinds) or ((type(value),) if dataclasses.is_dataclass(value) else ())
    return tuple(dict.fromkeys(field.name for kind in found for field in dataclasses.fields(kind)))


def replace_variant(path: str, variants: Variants, old: Any, changes: Mapping[str, Any]) -> Any:
    """Return the new value of a field that has variants: select the record, then replace its fields.

    Args:
        path: Name of the field, for messages.
        variants: Its variants by word.
        old: Its value.
        changes: Values by name of a field of the record; "" selects the record, by its word or as a whole. The word
            of the type of `old` keeps its fields; the word of another type starts from that type's defaults.

    Raises:
        ConfigError: The word is unknown, or the selected record does not have one of the fields.
    """
    values = {name: value for name, value in changes.items() if name}
    selected = _select(path, variants, old, changes[""]) if "" in changes else old
    for name in values:
        if name not in getattr(selected, "__dataclass_fields__", {}):
            raise _unused_option(path, variants, name, selected)
    if isinstance(selected, type):
        return selected(**values)
    return dataclasses.replace(selected, **values) if values else selected


def _select(path: str, variants: Variants, old: Any, choice: Any) -> Any:
    """Return the selected variant: a record, the type of a record that the caller constructs, or None.

    Records are returned as they are, and so is None where it is a variant. A word returns `old` if that has the word's
    type, otherwise the type.

    Raises:
        UnknownNameError: The choice is neither a variant nor one of the words.
    """
    if isinstance(choice, _types(variants)) or (choice is None and None in variants.values()):
        return choice
    words = {word: kind for word, kind in variants.items() if type(word) is type(choice)}
    if not isinstance(choice, Hashable) or choice not in words:
        hint = did_you_mean(str(choice), [str(word) for word in variants])
        raise UnknownNameError(f"unknown `{path}` {shorten(choice)}", hint=hint)
    kind = words[choice]
    return old if kind is type(old) else kind


def _unused_option(path: str, variants: Variants, name: str, selected: Any) -> ConfigError:
    """Return the error for an option that the selected variant does not have; it names the variants that do."""
    words = [repr(word) for word, kind in variants.items() if name in getattr(kind, "__dataclass_fields__", {})]
    now = "None" if selected is None else getattr(selected, "__name__", type(selected).__name__)
    return ConfigError(f"`{path}.{name}` has no effect with {now}", hint=f"Set `{path}` to {' or '.join(words)} too.")


def override_fields(record: Any, changes: Mapping[str, Any]) -> Any:
    """Return a record with fields replaced by name; an unambiguous field of a nested record may be named directly.

    Args:
        record: A frozen dataclass.
        changes: Values by name of one of its fields, or of a field that only one of its nested records has.

    Raises:
        ConfigError: A name is unknown, or a value is invalid.
    """
    owners = _owners(record)
    below: dict[str, dict[str, Any]] = defaultdict(dict)
    for name, value in changes.items():
        if name not in owners:
            raise UnknownNameError(f"unknown option `{name}`", hint=did_you_mean(name, owners))
        below[owners[name]]["" if owners[name] == name else name] = value
    return dataclasses.replace(record, **{name: _replaced(record, name, values) for name, values in below.items()})


def _owners(record: Any) -> dict[str, str]:
    """Map own fields to themselves, nested records' fields to the field that holds them; omit ambiguous ones."""
    own = [field.name for field in dataclasses.fields(record)]
    nested = [(option, name) for name in own for option in nested_names(record, name) if option not in own]
    options = [option for option, _ in nested]
    return {option: name for option, name in nested if options.count(option) == 1} | {name: name for name in own}


def _replaced(record: Any, name: str, changes: Mapping[str, Any]) -> Any:
    """Return the new value of field `name`: "" in `changes` replaces it whole, other names its record's fields."""
    old, variants = getattr(record, name), variants_of(record, name)
    if variants:
        return replace_variant(name, variants, old, changes)
    values = {option: value for option, value in changes.items() if option}
    new = changes.get("", old)
    if dataclasses.is_dataclass(old):
        check_type(name, new, type(old))
    return dataclasses.replace(new, **values) if values else new


def _types(variants: Variants) -> tuple[type, ...]:
    """Return the record types of variants, without None."""
    return tuple(kind for kind in variants.values() if kind is not None)
