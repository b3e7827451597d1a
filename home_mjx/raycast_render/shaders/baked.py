"""The shader `baked`: the light of faces that stand still is looked up in baked texels, without shadow rays."""

from dataclasses import dataclass
from typing import ClassVar

import jax
import jax.numpy as jnp
from jaxtyping import Array, Int

from home_mjx.bank.records.lights import LIGHT_PROBES, SUN_ELEVATION, TEXEL_SUN_AZIMUTH, LightProbes
from home_mjx.raycast_render.lighting import lights
from home_mjx.raycast_render.lighting.probes import Daylight, probe_room
from home_mjx.raycast_render.lighting.texels import MixedTexels, find_chart, mix_texels, texel_irradiance
from home_mjx.raycast_render.scene.appearance import AppearanceOverrides
from home_mjx.raycast_render.scene.types import Hit, Scene
from home_mjx.raycast_render.scene.vec import Vec, select
from home_mjx.raycast_render.shaders.base import register_shader
from home_mjx.raycast_render.shaders.lit import LitShader, probe_light


@register_shader
@dataclass(frozen=True)
class BakedShader(LitShader):
    """`lit` without shadow rays for floors, walls, ceilings and large faces of furniture: texels have all their light.

    Other surfaces, such as movable objects, door leaves and round furniture, are lit as by `lit`. Movable objects and
    doors cast no shadows on texels, and these have no highlights. The sun of texels is that of the default options;
    with another direction it is not in them, and every surface gets a ray to the sun.
    """

    name: ClassVar[str] = "baked"
    needs: ClassVar[tuple[str, ...]] = (LIGHT_PROBES,)
    uses: ClassVar[tuple[str, ...]] = ()

    def incident(
        self, scene: Scene, hit: Hit, point: lights.ShadingPoint, sample: lights.LightSample
    ) -> tuple[Vec, Vec]:
        """Return irradiance and specular radiance as of `LitShader`; `ambient` scales all light of texels."""
        probes: LightProbes = scene.bank.bakes[LIGHT_PROBES]
        point = point.replace(room=probe_room(scene, point))
        chart, sunny = find_chart(scene, probes, hit), self._texels_have_sun(scene.appearance)
        fixed = texel_irradiance(probes, self._texels(scene, probes), scene.house, point.pos, chart)
        light = select(chart < 0, probe_light(scene, probes, point, self), fixed) * self.ambient
        others = point.replace(instance=jnp.where(chart < 0, point.instance, -1))
        got = self._key_light(scene, probes, others, sample)
        if self.sun > 0:
            got = jax.tree.map(jnp.add, got, self._sun_light(scene, others if sunny else point, sample))
        specular = got.specular + self._reflected(scene, probes, point) if self.reflections else got.specular
        return got.diffuse + light, specular

    def _mix_texels(
        self, probes: LightProbes, house: Int[Array, ""], look: AppearanceOverrides | None, day: Daylight
    ) -> MixedTexels:
        """Mix the light of texels with that of key lamps, and of the sun where it stands for texels."""
        return mix_texels(probes, house, look, day, self.num_lights > 0, self._texels_have_sun(look))

    def _texels_have_lamps(self) -> bool:
        """Return whether texels have the light of key lamps."""
        return True

    def _texels_have_sun(self, look: AppearanceOverrides | None) -> bool:
        """Return whether the sun stands where it stands for the texels, in every episode."""
        fixed = look is None or (look.sun_azimuth is None and look.sun_elevation is None)
        return fixed and (self.sun_azimuth, self.sun_elevation) == (TEXEL_SUN_AZIMUTH, SUN_ELEVATION)
