"""States of SUNCG's models as suffixes of file names: `122` is the open door, `122_0` the same door closed."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from home_mjx.schema.house import Light, Metadata, ModelInfo


def variant_key(model_id: str, state: int | None) -> str:
    """Return the stem of the OBJ of a model in a state of house.json; None and 0 are the base model.

    Example:
        >>> variant_key("122", None), variant_key("122", 1)
        ('122', '122_0')
    """
    return model_id if not state else f"{model_id}_{state - 1}"


def state_of(model_id: str, key: str) -> int:
    """Return the state of a model from the stem `key` of its OBJ, the inverse of `variant_key`; 0 for the base model.

    Example:
        >>> state_of("122", "122"), state_of("122", "122_0")
        (0, 1)
    """
    return 0 if key == model_id else int(key.removeprefix(f"{model_id}_")) + 1


def other_variant(model_id: str, key: str) -> str:
    """Return the stem of the other state's OBJ: `<id>_0` (closed) for the base model, the base model for others."""
    return model_id if key != model_id else f"{model_id}_0"


def base_model(model_id: str, known: Callable[[str], bool]) -> str:
    """Return the base model of a variant (`122` of `122_0`, `s__12` of `s__12_2`), or the model itself.

    Ids themselves contain underscores and digits, so `known` decides, which returns whether a model id exists.

    Example:
        >>> models = {"122", "s__12", "s__1296", "table_1"}
        >>> [base_model(key, models.__contains__) for key in ("122_0", "s__12_2", "s__1296", "table_1", "table_1_0")]
        ['122', 's__12', 's__1296', 'table_1', 'table_1']
    """
    base, _, variant = model_id.rpartition("_")
    is_variant = len(variant) == 1 and variant in "0123456789" and not known(model_id) and known(base)
    return base if is_variant else model_id


@dataclass(frozen=True)
class SuncgMetadata(Metadata):
    """Metadata tables of a SUNCG dataset; variants without a row of their own have that of their base model."""

    lights: Mapping[str, tuple[Light, ...]] = field(default_factory=dict)  # by stem of an OBJ

    def info(self, model_id: str) -> ModelInfo:
        """Return the row of a model, or of a variant's base; for others a row of category `unknown` without size."""
        return self.models.get(base_model(model_id, self.models.__contains__)) or ModelInfo(model_id)

    def lights_of(self, model_id: str, key: str) -> tuple[Light, ...]:
        """Return the lights of the state with the OBJ stem `key`; else those of the base model; () without any."""
        return self.lights.get(key) or self.lights.get(base_model(model_id, self.lights.__contains__), ())
