"""Materials of glTF files: images that are lost, and models of metals."""

import io

import numpy as np
import pytest
from gltf_files import GltfFile
from PIL import Image

from home_mjx.datasets.gltf.decode.container import TEXTURE_EXTENSIONS, read_document
from home_mjx.datasets.gltf.decode.images import ImageStore
from home_mjx.datasets.gltf.decode.materials import MaterialReader
from home_mjx.datasets.suncg.formats.json_value import JsonValue
from home_mjx.errors import DatasetError

METAL = {"metallicFactor": 1.0, "roughnessFactor": 0.7}


def png() -> bytes:
    stream = io.BytesIO()
    Image.new("RGB", (2, 2), (128, 128, 255)).save(stream, "PNG")
    return stream.getvalue()


def read(tmp_path, strict: bool, **material):
    """Return the one material of a file, its notes and the fallbacks of its images.

    Texture 0 is a PNG, texture 1 has no file, and texture 2 a WebP image alone.
    """
    file = GltfFile()
    file.add("images", bufferView=file.view(png()), mimeType="image/png")
    file.add("images", uri="none.png")
    file.add("images", bufferView=file.view(b"RIFF" + bytes(32)), mimeType="image/webp")
    file.add("textures", source=0)
    file.add("textures", source=1)
    file.add("textures", extensions={"EXT_texture_webp": {"source": 2}})
    file.add("materials", **material)
    document = read_document(file.write(tmp_path / "a.glb"), TEXTURE_EXTENSIONS)
    images = ImageStore(document, tmp_path, strict)
    reader = MaterialReader(document, images)
    return reader.material(JsonValue(document.path, "", 0)).material, reader.notes, images.fallbacks


@pytest.mark.parametrize("texture", [{"index": 1}, {"index": 2}, {"index": 0, "texCoord": 1}])
def test_a_material_without_its_image_of_emission_does_not_glow(tmp_path, texture):
    color = {"baseColorTexture": {"index": 0}}
    material, notes, fallbacks = read(
        tmp_path, False, pbrMetallicRoughness=color, emissiveFactor=[1, 1, 1], emissiveTexture=texture
    )
    assert material.maps is None
    assert len(notes) + len(fallbacks) == 1
    assert all(fallback.replacement == "no emission" for fallback in fallbacks)


def test_a_lost_image_of_emission_is_an_error_if_strict(tmp_path):
    with pytest.raises(DatasetError, match=r"missing.*images\[1\]|none.png"):
        read(tmp_path, True, emissiveFactor=[1, 1, 1], emissiveTexture={"index": 1})


@pytest.mark.parametrize("key", ["normalTexture", "occlusionTexture"])
@pytest.mark.parametrize("index", [1, 2])
def test_lost_images_that_only_exports_use_are_notes_even_if_strict(tmp_path, key, index):
    material, notes, fallbacks = read(tmp_path, True, emissiveFactor=[0, 1, 0], **{key: {"index": index}})
    assert material.maps.images == (None, None, None, None)
    assert material.maps.emission == (0, 1, 0)
    assert (list(notes), fallbacks) == ([f"materials[0].{key}"], [])


def test_an_image_that_is_lost_as_a_map_is_a_fallback_as_a_colour(tmp_path):
    shade = {"baseColorTexture": {"index": 1}}
    material, notes, fallbacks = read(
        tmp_path, False, pbrMetallicRoughness=shade, normalTexture={"index": 1}, occlusionTexture={"index": 0}
    )
    assert [fallback.replacement for fallback in fallbacks] == ["the material's colour"]
    assert material.maps.images[3] is not None
    assert list(notes) == ["materials[0].normalTexture"]


def test_glossy_materials_are_no_metals(tmp_path):
    """They have no metallic-roughness model, or one for readers without the extension, with a texture."""
    gloss = {"KHR_materials_pbrSpecularGlossiness": {"glossinessFactor": 0.75}}
    for shade in ({}, {"pbrMetallicRoughness": {**METAL, "metallicRoughnessTexture": {"index": 0}}}):
        material, _, _ = read(tmp_path, True, extensions=gloss, normalTexture={"index": 0}, **shade)
        maps = material.maps
        assert (maps.metallic, maps.roughness) == (0, pytest.approx(0.25))
        assert [path is not None for path in maps.images] == [False, True, False, False]


@pytest.mark.parametrize(("texture", "metallic"), [(0, 1.0), (1, 0.0), (2, 0.0)])
def test_factors_of_a_lost_metallic_texture_do_not_make_a_metal(tmp_path, texture, metallic):
    shade = {**METAL, "metallicRoughnessTexture": {"index": texture}}
    material, _, _ = read(tmp_path, True, pbrMetallicRoughness=shade, emissiveFactor=[0, 1, 0])
    assert (material.maps.metallic, material.maps.roughness) == (metallic, 0.7)
    np.testing.assert_allclose(material.specular, [0.04] * 3)
