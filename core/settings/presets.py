"""The three presets as overrides of the defaults, and how a run's settings are made from one."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Literal, get_args

from pydantic import ValidationError
from pydantic.fields import FieldInfo

from core.errors import BadInput
from core.names import nearest
from core.settings import groups, reading
from core.settings.base import Group, option
from core.settings.limits import LimitSettings
from core.settings.row import RowSettings
from core.settings.scale import ScaleSettings

PresetName = Literal["default", "thesis", "draft"]
PRESET_NAMES: tuple[str, ...] = get_args(PresetName)


class Settings(Group):
    """Everything that can change a result, frozen and versioned."""

    version: int = option(1, "version of the meaning of these options", source="this project", ge=1, le=1)
    preset: PresetName = option("default", "preset the values started from", source="this project")
    seed: int = option(0, "seed of every random choice", source="this project", ge=0, lt=2**31)
    input: reading.InputSettings = reading.InputSettings()
    frames: groups.FrameSettings = groups.FrameSettings()
    roi: groups.RoiSettings = groups.RoiSettings()
    camera: groups.CameraSettings = groups.CameraSettings()
    features: groups.FeatureSettings = groups.FeatureSettings()
    matching: groups.MatchSettings = groups.MatchSettings()
    verification: groups.VerificationSettings = groups.VerificationSettings()
    windows: groups.WindowSettings = groups.WindowSettings()
    mapper: groups.MapperSettings = groups.MapperSettings()
    model: groups.ModelSettings = groups.ModelSettings()
    dense: groups.DenseSettings = groups.DenseSettings()
    fusion: groups.FusionSettings = groups.FusionSettings()
    mesh: groups.MeshSettings = groups.MeshSettings()
    mapping: groups.MappingSettings = groups.MappingSettings()
    timeline: groups.TimelineSettings = groups.TimelineSettings()
    row: RowSettings = RowSettings()
    scale: ScaleSettings = ScaleSettings()
    limits: LimitSettings = LimitSettings()
    gallery: groups.GallerySettings = groups.GallerySettings()
    compute: groups.ComputeSettings = groups.ComputeSettings()
    overrides: tuple[str, ...] = option((), "names that the user set, sorted", source="the run")


_PRESETS: dict[str, dict[str, object]] = {
    "default": {},
    "thesis": {
        "frames.clip_start_s": 2.0,
        "frames.clip_end_s": 121.0,
        "frames.include_annotated": False,
        "frames.neighbour_s": 0.0,
        "frames.time_rule": "average_rate",
        "frames.mask_still": False,
        "camera.focal": "colmap",
        "camera.principal_point": "crop",
        "features.subpixel": False,
        "matching.method": "lightglue",
        "matching.keyframes": False,
        "matching.bridge": False,
        "verification.max_error_px": 4.0,
        "verification.min_inlier_share": 0.0,
        "windows.start": "scratch",
        "mapper.initial_pair": "colmap",
        "mapper.bundle_adjustment": "colmap",
        "mapper.refine_distortion": True,
        "mapper.search_tracks": 0,
        "model.veto": False,
        "model.prefer_verified": False,
        "model.drop_loose": False,
        "model.further": 0,
        "model.confirm": False,
        "model.register_rest": False,
        "model.join": False,
        "model.final_adjustment": False,
        "model.refine_principal_point": "never",
        "dense.views": 0,
        "dense.sources": 20,
        "fusion.min_num_pixels": 5,
        "fusion.max_normal_error_deg": 10.0,
        "mesh.poisson_depth": 13,
        "mesh.poisson_trim": 10.0,
        "mesh.keep_unsupported": True,
        "mapping.method": "thesis",
        "mapping.box_frame": "crop",
        "mapping.time_rule": "average_rate",
    },
    "draft": {
        "frames.count": 120,
        # 120 frames in all keep a draft quick; detections go to the nearest of them in time.
        "frames.include_annotated": False,
        "camera.focal_spans": 1,
        "features.max_keypoints": 2048,
        "features.scale": 0.5,
        "matching.method": "mutual_nearest",
        "windows.mode": "single",
        "dense.views": 30,
        "dense.scale": 0.5,
    },
}


def option_names() -> dict[str, FieldInfo]:
    """Every option that can be set, dotted name -> its declaration, in the order of declaration."""
    return dict(_walk(Settings, ""))


def _walk(model: type[Group], prefix: str) -> Iterator[tuple[str, FieldInfo]]:
    for name, info in model.model_fields.items():
        if isinstance(info.annotation, type) and issubclass(info.annotation, Group):
            yield from _walk(info.annotation, f"{prefix}{name}.")
        elif prefix or name == "seed":
            yield f"{prefix}{name}", info


def preset_values(preset: str) -> dict[str, object]:
    """Dotted overrides that make `preset` from the defaults; `BadInput` for an unknown preset."""
    if preset not in _PRESETS:
        raise BadInput(f"unknown preset '{preset}'; known: {', '.join(PRESET_NAMES)}", where="preset")
    return dict(_PRESETS[preset])


def make_settings(preset: str = "default", options: Mapping[str, object] | None = None) -> Settings:
    """Settings of a preset with named overrides, e.g. ``{"matching.window": 8}``.

    Values may be JSON values or text as on the command line. With `camera.params`, `mapper.refine_lens` is false
    unless it is named. Raises `BadInput` that names the unknown
    option (with the nearest known one) or the value that does not fit.
    """
    chosen = dict(options or {})
    known = option_names()
    for name in chosen:
        if name not in known:
            near = nearest(name, known)
            hint = f"; did you mean '{near}'?" if near else "; `bladeatlas options` lists all"
            raise BadInput(f"unknown option '{name}'{hint}", where=name)
    values: dict[str, object] = {"preset": preset, "overrides": tuple(sorted(chosen))}
    if chosen.get("camera.params") is not None:
        # A lens that was measured is worth more than what one clip says of it.
        chosen.setdefault("mapper.refine_lens", False)
    groups_of_values: dict[str, dict[str, object]] = {}
    for name, value in {**preset_values(preset), **chosen}.items():
        group, _, leaf = name.rpartition(".")
        (groups_of_values.setdefault(group, {}) if group else values)[leaf] = value
    try:
        return Settings.model_validate({**values, **groups_of_values})
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(part) for part in first["loc"])
        if first["type"] == "value_error":  # of our own validators, whose sentences name the options
            raise BadInput(str(first["ctx"]["error"]), where=where) from None
        raise BadInput(f"option '{where}': {first['msg']} (got {first['input']!r})", where=where) from None
