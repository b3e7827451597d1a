"""Which model a variant belongs to, by what models there are and not by what ids look like."""

import pytest

from home_mjx.datasets.suncg.formats.asset_library import AssetLibrary
from home_mjx.datasets.suncg.formats.variants import SuncgMetadata, base_model
from home_mjx.schema.house import ModelInfo

IDS = ("122", "s__1762", "s__1", "gen_coffee_table_1", "gen_coffee_table", "stores__3__1183")
VARIANTS = {
    "122_0": "122",
    "122_2": "122",
    "s__1762_0": "s__1762",
    "s__1_2": "s__1",
    "gen_coffee_table_1_0": "gen_coffee_table_1",
    "gen_coffee_table_1_2": "gen_coffee_table_1",
    "stores__3__1183_2": "stores__3__1183",
}
OTHERS = ("s__1296", "s__12", "gen_coffee_table_12", "123_0", "122_x", "122_10", "_0", "__0", "122_\u0661")


@pytest.fixture
def objects(tmp_path):
    for name in IDS:
        (tmp_path / "object" / name).mkdir(parents=True)
    return AssetLibrary(tmp_path)


@pytest.mark.parametrize(("variant", "base"), VARIANTS.items())
def test_variants_belong_to_their_base(variant, base, objects):
    assert base_model(variant, IDS.__contains__) == base
    assert SuncgMetadata({key: ModelInfo(key, fine=key) for key in IDS}).info(variant).fine == base
    assert objects.model_path(variant, variant) == objects.root / "object" / base / f"{variant}.obj"


@pytest.mark.parametrize("model_id", [*IDS, *OTHERS])
def test_what_is_no_variant_of_a_known_model_is_itself(model_id, objects):
    assert base_model(model_id, IDS.__contains__) == model_id
    assert objects.model_path(model_id, model_id) == objects.root / "object" / model_id / f"{model_id}.obj"


def test_a_variant_with_a_row_of_its_own_keeps_it():
    metadata = SuncgMetadata({"122": ModelInfo("122", fine="door"), "122_0": ModelInfo("122_0", fine="closed")})
    assert metadata.info("122_0").fine == "closed"


def test_an_id_that_ends_like_a_variant_of_a_folder_above_stays_below_objects(objects):
    for model_id in ("..._0", ".._0", "._0"):
        path = objects.model_path(model_id, model_id)
        assert path.parent == objects.root / "object" / model_id
