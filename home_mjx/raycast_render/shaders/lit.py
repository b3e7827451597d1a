"""The shader `lit`: direct light with shadows, baked indirect light, glass, mirrors, highlights, filtered textures.

Where the bank has light probes, they and the texels of faces give indirect light, that of the sky, and that of all but
two lamps. Without them windows are lights, and indirect light is uniform within a room.
"""

import math
from dataclasses import dataclass, fields
from typing import Any, ClassVar

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.bank.bank import HouseBank
from home_mjx.bank.records.lights import LIGHT_PROBES, NUM_KEY_LAMPS, LightProbes
from home_mjx.core.checks import check_known, check_number
from home_mjx.core.native.platforms import with_fallback_gradient
from home_mjx.core.pytree import Pytree
from home_mjx.raycast_render.cameras.camera import pixel_footprint
from home_mjx.raycast_render.cameras.sampling import sample_points
from home_mjx.raycast_render.casting.cast import occluded
from home_mjx.raycast_render.light_kernel import cuda
from home_mjx.raycast_render.light_kernel import surface_light as native
from home_mjx.raycast_render.light_kernel.operands import LightInputs
from home_mjx.raycast_render.lighting import lights, outside, texture
from home_mjx.raycast_render.lighting.gloss import edge_factor, reflect_view, uniform_gloss
from home_mjx.raycast_render.lighting.probes import (
    Daylight,
    MixedProbes,
    PreparedLight,
    mix_groups,
    open_irradiance,
    pack_colors,
    probe_irradiance,
    probe_room,
    varies,
)
from home_mjx.raycast_render.lighting.specular import PathState, start_path, trace_specular
from home_mjx.raycast_render.lighting.sun_and_sky import MIN_SKY_SHARE, sky_share, sun_position, sun_redness, sun_share
from home_mjx.raycast_render.lighting.texels import MixedTexels, find_chart, mix_texels, texel_irradiance
from home_mjx.raycast_render.lighting.tone_curves import TONE_CURVES
from home_mjx.raycast_render.scene.appearance import (
    AppearanceOverrides,
    instance_glow,
    scale_daylight,
    scale_exposure,
    scale_lamps,
    swap_textures,
    tint_materials,
)
from home_mjx.raycast_render.scene.surface import (
    area_to_world,
    area_vectors,
    material_rows,
    semantics,
    texture_coordinates,
    texture_corners,
)
from home_mjx.raycast_render.scene.types import Hit, Scene
from home_mjx.raycast_render.scene.vec import Vec, select, take, take_vec
from home_mjx.raycast_render.shaders.base import CameraRays, Shader, find_prepared, register_shader
from home_mjx.schema.lighting import MEAN_REFLECTANCE
from home_mjx.schema.semantic import Semantic

MEAN_LUMINANCE_TARGET = 0.5  # target of the mean luminance after exposure; `tone_map` maps it to 0.34
MIN_METERED_LUMINANCE = 1e-4  # [W/m^2/sr], minimum luminance in auto exposure
ZENITH_COLOR, HORIZON_COLOR, GROUND_COLOR = (0.45, 0.68, 1.0), (0.9, 0.96, 1.0), (0.2, 0.21, 0.16)  # times sky radiance
GLOW_COLOR, GLOW_RADIANCE = (0.8, 0.9, 1.0), 0.8  # colour; [W/m^2/sr], of surfaces with glow 1
DUSK_COLOR = (1.35, 0.72, 0.42)  # factor at the horizon at sunset


class HitFrame(Pytree):
    """Normals of the hit triangle, in the world."""

    area: Vec  # normal facing the ray, with a length of twice the area [m^2]
    shading: Vec  # unit smooth normal, on the same side


@register_shader
@dataclass(frozen=True)
class LitShader(Shader):
    """The lights of the house with shadows, glass, mirrors, specular highlights and filtered textures.

    Rays per sample: at most 1 + max_specular_depth + num_lights + 1 (sun) + 1 (ambient occlusion).

    Attributes:
        num_lights: Lights per point, those with the highest unoccluded irradiance; lights of other rooms are weighted
            by 0.1. A shadow ray tests each light, so none shines through walls. With light probes at most two, those
            that give each room the most light.
        max_specular_depth: Maximum number of specular events: glass and mirrors.
        sun: Normal irradiance of the sun [W/m^2]; 0 disables the sun and its rays.
        sun_azimuth: Direction to the sun from +x towards +y [degrees].
        sun_elevation: Elevation of the sun above the horizon [degrees]; below 18 sunlight and horizon are redder.
        sky: Radiance of the sky [W/m^2/sr], outdoors and through windows; 0: night.
        ambient: Factor of the interreflected light.
        ao_radius: Ambient-occlusion radius [m]; 0 disables ambient occlusion. Noisy unless the lens takes several
            samples per pixel.
        reflections: Glossy surfaces reflect the light of probes, blurred; without probes no effect.
        exposure: Factor of all light before tone mapping. None: auto exposure, which maps the mean luminance of each
            image to middle grey.
        clouds: Share of the sky that clouds cover, 0 to 1, as cameras see it; they neither light nor shade.
        haze: Extinction of the air [1/m], as cameras see it: 0.001 is a light haze, in which 1 km keeps 37 % of
            contrast.
        grass: Blades and tufts of lawns, as cameras see them.
        tone_curve: Tone curve: "reinhard", or "agx", in which bright colours fade to white as on film.

    Raises:
        ConfigError: A value is invalid.
    """

    name: ClassVar[str] = "lit"
    uses: ClassVar[tuple[str, ...]] = (LIGHT_PROBES,)
    overrides: ClassVar[frozenset[str]] = frozenset({"lamps", "daylight", "sun_azimuth", "sun_elevation"})

    num_lights: int = 4
    max_specular_depth: int = 2
    sun: float = 9.0
    sun_azimuth: float = 250.0
    sun_elevation: float = 35.0
    sky: float = 3.0
    ambient: float = 1.0
    ao_radius: float = 0.0
    exposure: float | None = 2.3
    reflections: bool = False
    clouds: float = 0.0
    haze: float = 0.0
    grass: bool = False
    tone_curve: str = "reinhard"

    def __post_init__(self) -> None:
        check_known("tone curve", [self.tone_curve], TONE_CURVES)
        check_number("clouds", self.clouds, 0, 1)
        for option in fields(self):
            if isinstance(option.default, bool | str) or (option.name == "exposure" and self.exposure is None):
                continue
            least = -math.inf if option.name.startswith("sun_") else 0
            check_number(option.name, getattr(self, option.name), least, integer=isinstance(option.default, int))

    @classmethod
    def from_hour(cls, hour: float, **options: Any) -> "LitShader":
        """Return options with the sun and sky of a time of day; `options` have priority over these.

        Args:
            hour: Solar time, 0 to 24. The sun rises at about 5, is highest at 12, and sets at about 19.
            options: Other fields.

        Raises:
            ConfigError: The hour or an option is invalid.

        Example:
            >>> LitShader.from_hour(23).sun, LitShader.from_hour(12).sun > LitShader.from_hour(18).sun
            (0.0, True)
        """
        check_number("hour", hour, 0, 24)
        azimuth, elevation = sun_position(hour)
        given: dict[str, Any] = {
            "sun": round(cls.sun * sun_share(elevation), 4),
            "sky": round(cls.sky * sky_share(elevation), 6),
            "sun_azimuth": round(azimuth, 3),
            "sun_elevation": round(elevation, 3),
        }
        return cls(**(given | options))

    def radiance(self, scene: Scene, rays: CameraRays) -> Vec:
        """Compute the radiance along camera rays, by glass and mirrors too [W/m^2/sr]; that of the sky on a miss."""
        path, growth = start_path(rays), pixel_footprint(rays.camera, rays.lens)[1]
        sample = self._light_sample(rays)

        def compose(scene: Scene, path: PathState, growth: Float[Array, ""], exclude: Int[Array, ""]) -> Array:
            """Compute it by operations of JAX, and by the kernel of surfaces where there is one."""
            return self._composed_radiance(scene, path, growth, exclude, sample).pack()

        def fuse(scene: Scene, path: PathState, growth: Float[Array, ""], exclude: Int[Array, ""]) -> Array:
            """Compute it by one kernel."""
            probes: LightProbes = scene.bank.bakes[LIGHT_PROBES]
            inputs = self._light_inputs(scene, probes)
            return cuda.path_radiance(scene, probes, path, growth, exclude, self.max_specular_depth, inputs).pack()

        simple = not (self.clouds or self.haze or self.grass)
        kernels = {"cuda": fuse} if simple and self._has_kernel(scene, sample, "cuda") else {}
        given = scene, path, growth, jnp.asarray(rays.exclude, jnp.int32)
        return Vec.unpack(with_fallback_gradient(compose, kernels)(*given) if kernels else compose(*given))

    def _has_kernel(self, scene: Scene, sample: lights.LightSample, platform: str) -> bool:
        """Return whether a kernel computes this light on a platform."""
        fits = LIGHT_PROBES in scene.bank.bakes and sample is None and not self.reflections
        return fits and scene.backend in (None, platform) and native.KERNEL.is_usable(platform)

    def _composed_radiance(
        self,
        scene: Scene,
        path: PathState,
        growth: Float[Array, ""],
        exclude: Int[Array, ""],
        sample: lights.LightSample,
    ) -> Vec:
        """Compute `radiance` by operations of JAX."""
        path = trace_specular(scene, path, growth, self.max_specular_depth, exclude)
        light = _add_glow(scene, path.hit, self._surface_light(scene, path, growth, sample))
        if self.grass:
            light = light * outside.grass_detail(scene, path, growth)
        above = scale_daylight(scene.appearance, sky_radiance(path.direction, self))
        return path.throughput * self._hazy(scene, path, select(path.hit.instance < 0, above, light))

    def _hazy(self, scene: Scene, path: PathState, light: Vec) -> Vec:
        """Return light behind haze, if there is any."""
        if self.haze == 0:
            return light
        horizon = lights.mix_colors(HORIZON_COLOR, DUSK_COLOR, sun_redness(self.sun_elevation)) * self.sky
        return outside.add_haze(path, light, scale_daylight(scene.appearance, horizon), self.haze)

    def _surface_light(
        self, scene: Scene, path: PathState, growth: Float[Array, ""], sample: lights.LightSample
    ) -> Vec:
        """Compute the radiance of surfaces [W/m^2/sr], by a kernel where there is one; arbitrary on a miss."""

        def compose(scene: Scene, path: PathState, growth: Float[Array, ""]) -> Array:
            """Compute it by operations of JAX."""
            return self._composed_light(scene, path, growth, sample).pack()

        def fuse(scene: Scene, path: PathState, growth: Float[Array, ""]) -> Array:
            """Compute it by the kernel."""
            probes: LightProbes = scene.bank.bakes[LIGHT_PROBES]
            return native.surface_light(scene, probes, path, growth, self._light_inputs(scene, probes))

        kernels = {"cpu": fuse} if self._has_kernel(scene, sample, "cpu") else {}
        return Vec.unpack(with_fallback_gradient(compose, kernels)(scene, path, growth))

    def _composed_light(
        self, scene: Scene, path: PathState, growth: Float[Array, ""], sample: lights.LightSample
    ) -> Vec:
        """Compute `_surface_light` by operations of JAX."""
        row = jnp.maximum(material_rows(scene, path.hit), 0)
        frame = _hit_frame(scene, path)
        point = _shading_point(scene, path, frame, row)
        color = _diffuse_reflectance(scene, path, frame, row, growth)
        # The barrier prevents recomputation of the surface for every light.
        point, color, row = jax.lax.optimization_barrier((point, color, row))
        diffuse, specular = self.incident(scene, path.hit, point, sample)
        return color * diffuse * (1 / math.pi) + take_vec(scene.bank.finish.specular, row) * specular

    def _light_inputs(self, scene: Scene, probes: LightProbes) -> LightInputs:
        """Return what kernels read of the light of an environment."""
        day, placed = daylight(scene.appearance, self), lights.place_lights(scene, 0.0)
        aim = lights.sun_aim(scene.appearance, self.sun_azimuth, self.sun_elevation)
        color = scale_daylight(scene.appearance, lights.sun_color(self.sun_elevation)) * self.sun
        above = (Vec(*ZENITH_COLOR) * day.sky, day.horizon * day.sky, Vec(*GROUND_COLOR) * day.sky)
        colors = [c for v in above for c in (v.x, v.y, v.z)]
        numbers = *colors, self.ambient, *(c for v in (aim, color) for c in (v.x, v.y, v.z))
        return LightInputs(
            probe=self.mixed_probes(scene, probes).light,
            texel=self._texels(scene, probes).light,
            lights=placed,
            lamps=lights.tabulate_lamps(scene, placed, probes.keys[scene.house]),
            sky=jnp.stack([jnp.asarray(x, jnp.float32) for x in (*numbers, scene.bank.spec.cell)]),
            num_lamps=min(self.num_lights, NUM_KEY_LAMPS),
            sun=self.sun > 0,
            baked=self._texels_have_lamps(),
            sunny=self._texels_have_sun(scene.appearance),
        )

    def _texels_have_lamps(self) -> bool:
        """Return whether texels have the light of key lamps."""
        return False

    def _texels_have_sun(self, look: AppearanceOverrides | None) -> bool:
        """Return whether texels have the light of the sun, in every episode."""
        return False

    def display(self, scene: Scene, light: Vec) -> Vec:
        """Map radiance to display light by the tone curve; auto exposure is computed before the episode's exposure."""
        exposure = auto_exposure(light) if self.exposure is None else self.exposure
        return TONE_CURVES[self.tone_curve](scale_exposure(scene.appearance, light), exposure)

    def incident(
        self, scene: Scene, hit: Hit, point: lights.ShadingPoint, sample: lights.LightSample
    ) -> tuple[Vec, Vec]:
        """Return irradiance and specular radiance for a specular reflectance of 1, see `lights.IncidentLight`."""
        probes = scene.bank.bakes.get(LIGHT_PROBES)
        if probes is None:
            indirect = _ambient(scene, point, sample, self)
            got = self._brightest_light(scene, point, sample)
        else:
            point = point.replace(room=probe_room(scene, point))
            indirect = self._baked_light(scene, probes, hit, point) * _near_blocking(scene, point, sample, self)
            got = self._key_light(scene, probes, point, sample)
        if self.sun > 0:
            got = jax.tree.map(jnp.add, got, self._sun_light(scene, point, sample))
        specular = got.specular
        if probes is not None and self.reflections:
            specular = specular + self._reflected(scene, probes, point)
        return got.diffuse + indirect, specular

    def _reflected(self, scene: Scene, probes: LightProbes, point: lights.ShadingPoint) -> Vec:
        """Return the light of probes from the mirrored direction, for a specular reflectance of 1 [W/m^2/sr]."""
        facing = point.replace(shading=reflect_view(point))
        return probe_light(scene, probes, facing, self) * (uniform_gloss(point) * (self.ambient / math.pi))

    def _baked_light(self, scene: Scene, probes: LightProbes, hit: Hit, point: lights.ShadingPoint) -> Vec:
        """Return the irradiance [W/m^2] by reflections, sky and far lamps: of texels, or probes for other faces."""
        around = probe_light(scene, probes, point, self)
        if probes.texel.shape[1]:
            chart = find_chart(scene, probes, hit)
            fixed = texel_irradiance(probes, self._texels(scene, probes), scene.house, point.pos, chart)
            around = select(chart < 0, around, fixed)
        return around * self.ambient

    def prepare(self, bank: HouseBank, house: Int[Array, ""], look: AppearanceOverrides | None) -> PreparedLight | None:
        """Mix the light groups of probes and texels for an episode whose lamps or daylight differ from the house's."""
        probes = bank.bakes.get(LIGHT_PROBES)
        if probes is None or not varies(look):
            return None
        day = daylight(look, self)
        mixed = mix_groups(probes, house, look, day).light, self._mix_texels(probes, house, look, day).light
        return PreparedLight(*map(pack_colors, mixed))

    def _mix_texels(
        self, probes: LightProbes, house: Int[Array, ""], look: AppearanceOverrides | None, day: Daylight
    ) -> MixedTexels:
        """Mix the light of texels that this shader looks up."""
        return mix_texels(probes, house, look, day)

    def mixed_probes(self, scene: Scene, probes: LightProbes) -> MixedProbes:
        """Return the light of probes in an environment: prepared, or mixed here."""
        prepared = find_prepared(scene, self)
        if prepared is not None:
            return MixedProbes(prepared.probes, 0)
        return mix_groups(probes, scene.house, scene.appearance, daylight(scene.appearance, self))

    def _texels(self, scene: Scene, probes: LightProbes) -> MixedTexels:
        """Return the light of texels in an environment: prepared, or mixed here."""
        prepared = find_prepared(scene, self)
        if prepared is not None:
            return MixedTexels(prepared.texels, 0)
        return self._mix_texels(probes, scene.house, scene.appearance, daylight(scene.appearance, self))

    def _key_light(
        self, scene: Scene, probes: LightProbes, point: lights.ShadingPoint, sample: lights.LightSample
    ) -> lights.IncidentLight:
        """Compute the direct light of the key lamps of rooms."""
        count = min(self.num_lights, NUM_KEY_LAMPS)
        if count == 0:
            return lights.no_light(point)
        placed = lights.place_lights(scene, 0.0)
        chosen = lights.key_lamps(lights.tabulate_lamps(scene, placed, probes.keys[scene.house]), point, count)
        return lights.lamp_light(scene, placed, point, sample, chosen)

    def _brightest_light(
        self, scene: Scene, point: lights.ShadingPoint, sample: lights.LightSample
    ) -> lights.IncidentLight:
        """Compute the direct light of the brightest lamps and windows at each point."""
        if self.num_lights == 0:
            return lights.no_light(point)
        placed = lights.place_lights(scene, self.sky)
        chosen = lights.brightest_lights(placed, point, self.num_lights)
        return lights.lamp_light(scene, placed, point, sample, chosen)

    def _sun_light(self, scene: Scene, point: lights.ShadingPoint, sample: lights.LightSample) -> lights.IncidentLight:
        """Compute the direct light of the sun."""
        return lights.sun_light(scene, point, sample, self.sun, self.sun_azimuth, self.sun_elevation)

    def _light_sample(self, rays: CameraRays) -> lights.LightSample:
        """Return positions in [-1, 1]² per pixel; None (lights' centres) with one sample and no ambient occlusion.

        They depend on the pixel and the index of the sample only, and are equal in all images of one shape.
        """
        if rays.lens.samples == 1 and not self.ao_radius:
            return None
        return 2 * sample_points(rays.sample, rays.hit.t.shape, seed=1) - 1


@register_shader
@dataclass(frozen=True)
class NightShader(LitShader):
    """`lit` without the sun and under a dark sky, with an exposure for lamplight; no rays go to the sun."""

    name: ClassVar[str] = "night"

    sun: float = 0.0
    sky: float = LitShader.sky * MIN_SKY_SHARE
    exposure: float | None = 3.2


def _add_glow(scene: Scene, hit: Hit, light: Vec) -> Vec:
    """Add the radiance of materials that emit and of surfaces that are switched on [W/m^2/sr]."""
    own, glow = texture.emission(scene, hit), instance_glow(scene.appearance, hit.instance)
    light = light if own is None else light + own * GLOW_RADIANCE
    return light if glow is None else light + Vec(*GLOW_COLOR) * (GLOW_RADIANCE * glow)


def auto_exposure(light: Vec) -> Float[Array, ""]:
    """Return the factor that maps an image's geometric mean luminance to `MEAN_LUMINANCE_TARGET`.

    Luminances are at least `MIN_METERED_LUMINANCE`. Source: equation 1 of the source of `tone_curves.tone_map`.
    """
    luminance = jnp.maximum(light.dot(Vec(*lights.LUMINANCE)), MIN_METERED_LUMINANCE)
    return MEAN_LUMINANCE_TARGET / jnp.exp(jnp.log(luminance).mean())


def sky_radiance(direction: Vec, options: LitShader) -> Vec:
    """Return the sky's radiance [W/m^2/sr] in world directions of any length; below horizontal, the bare ground's.

    Both are proportional to `options.sky`.
    """
    up = direction.z * direction.inverse_norm()
    high = jnp.sqrt(jnp.clip(up, 0.0, 1.0))
    horizon = lights.mix_colors(HORIZON_COLOR, DUSK_COLOR, sun_redness(options.sun_elevation))
    above = horizon + (Vec(*ZENITH_COLOR) - horizon) * high
    plain = select(up >= 0, above, Vec(*GROUND_COLOR)) * options.sky
    return outside.add_clouds(plain, direction, options.clouds, options.sky) if options.clouds else plain


def _hit_frame(scene: Scene, path: PathState) -> HitFrame:
    """Return area normals, as long as twice the area [m^2], and unit smooth normals of hits, in the world.

    Area normals face the rays. Smooth normals are on their side, so that near a silhouette they may face away from the
    rays. Without a stored smooth normal, the area normal is used, scaled to length 1. Both are arbitrary on a miss.
    """
    hit = path.hit
    area = area_vectors(scene, path.direction, hit)
    a, b, c = (take_vec(scene.bank.finish.normal, jnp.maximum(hit.triangle, 0), k) for k in range(3))
    smooth = area_to_world(scene, a * (1 - hit.u - hit.v) + b * hit.u + c * hit.v, hit)
    side = smooth.dot(area)
    smooth = select(side < 0, -smooth, smooth)
    return HitFrame(area, select(smooth.dot(smooth) > 0, smooth, area).unit())


def _shading_point(scene: Scene, path: PathState, frame: HitFrame, row: Int[Array, "*rays"]) -> lights.ShadingPoint:
    """Gather position, normals, view direction, shininess of material `row`, instance and room at the ends of paths."""
    return lights.ShadingPoint(
        pos=path.end,
        normal=frame.area.unit(),
        shading=frame.shading,
        view=-path.direction.unit(),
        shininess=take(scene.bank.finish.shininess, row),
        instance=path.hit.instance,
        room=semantics(scene, path.hit, Semantic.ROOM),
        edge=edge_factor(take_vec(scene.bank.finish.specular, row)),
    )


def _diffuse_reflectance(
    scene: Scene, path: PathState, frame: HitFrame, row: Int[Array, "*rays"], growth: Float[Array, ""]
) -> Vec:
    """Return the material's colour times its texture, filtered over a footprint that grows by `growth` [m] per t.

    The episode's overrides of colours and textures are included. Arbitrary on a miss.
    """
    hit, materials, textures = path.hit, scene.bank.materials, scene.bank.materials.textures
    u, v = texture_corners(scene, hit)
    texels = (u.y - u.x) * (v.z - v.x) - (v.y - v.x) * (u.z - u.x)
    texels = jnp.abs(texels) * texture.texture_edge(textures) ** 2
    inverse = frame.area.inverse_norm()
    facing = jnp.abs(frame.area.dot(path.direction)) * inverse * path.direction.inverse_norm()
    width = path.footprint + growth * jnp.where(hit.instance < 0, 0.0, hit.t)
    footprint = width * width / jnp.maximum(facing, 0.05)
    level = texture.mip_level(footprint * texels * jnp.minimum(inverse, 1e12))
    layer = swap_textures(scene.appearance, take(materials.texture, row), row, materials.texture)
    texel = texture.sample_trilinear(textures, jnp.maximum(layer, 0), *texture_coordinates(scene, hit), level)
    color = tint_materials(scene.appearance, take_vec(materials.albedo, row), row)
    return select(layer < 0, color, color * texel)


def _ambient(scene: Scene, point: lights.ShadingPoint, spread: lights.LightSample, options: LitShader) -> Vec:
    """Return the irradiance [W/m^2] by interreflection without probes: uniform within a room.

    Points outside all rooms have that of row 0 of the table.
    """
    table = scene.bank.lights.ambient
    place = scene.house * table.shape[1] + jnp.clip(point.room + 1, 0, table.shape[1] - 1)
    lamps, daylight = (take_vec(table.reshape(-1, 2, 3), place, source) for source in range(2))
    daylight = daylight * Vec(*lights.SKY_COLOR) * options.sky
    lamps = scale_lamps(scene.appearance, lamps, jnp.bool_(False), point.room)
    daylight = scale_lamps(scene.appearance, daylight, jnp.bool_(True), point.room)
    return (lamps + daylight) * options.ambient * _near_blocking(scene, point, spread, options)


def probe_light(scene: Scene, probes: LightProbes, point: lights.ShadingPoint, options: LitShader) -> Vec:
    """Return the irradiance [W/m^2] of probes; outdoors of the open sky."""
    day, mixed = daylight(scene.appearance, options), options.mixed_probes(scene, probes)
    inside = probe_irradiance(probes, mixed, scene.house, point.pos, point.shading, point.room)
    outside = open_irradiance(day, Vec(*ZENITH_COLOR), Vec(*GROUND_COLOR), point.shading)
    return select(point.room < 0, outside, inside)


def daylight(look: AppearanceOverrides | None, options: LitShader) -> Daylight:
    """Return the daylight of an environment."""
    redness = sun_redness(options.sun_elevation)
    turned = None if look is None else look.sun_azimuth
    factor = 1.0 if look is None or look.daylight is None else look.daylight
    return Daylight(
        sky=factor * options.sky,
        horizon=lights.mix_colors(HORIZON_COLOR, DUSK_COLOR, redness),
        sun=lights.mix_colors(lights.SUN_COLOR, lights.SUNSET_COLOR, redness) * (factor * options.sun),
        azimuth=options.sun_azimuth if turned is None else jnp.rad2deg(turned),
    )


def _near_blocking(
    scene: Scene, point: lights.ShadingPoint, spread: lights.LightSample, options: LitShader
) -> Float[Array, "*rays"] | float:
    """Return `MEAN_REFLECTANCE` where one random ray per point is blocked within `ao_radius`, else 1."""
    if options.ao_radius <= 0 or spread is None:
        return 1.0
    near = occluded(
        scene,
        (point.pos + point.normal * lights.SHADOW_BIAS).pack(),
        _cosine_direction(point.shading, spread).pack(),
        t_max=jnp.where(point.instance < 0, -1.0, options.ao_radius),
    )
    return jnp.where(near, MEAN_REFLECTANCE, 1.0)


def _cosine_direction(normal: Vec, spread: Float[Array, "*rays 2"]) -> Vec:
    """Map points `spread`, uniform in [-1, 1]^2, to cosine-distributed unit directions about the unit normal."""
    z, turn = 0.999 * spread[..., 0], math.pi * spread[..., 1]
    ring = jnp.sqrt(1 - z * z)
    return (normal + Vec(ring * jnp.cos(turn), ring * jnp.sin(turn), z)).unit()
