"""Products of the stages before the search: from the video to the verified view graph."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

from core.flags import Flag
from core.json_files import JsonObject
from core.products.contract import OMITTED, Product


@dataclass(frozen=True, kw_only=True)
class VideoLength:
    """How long one of several videos is."""

    n_frames: int
    duration_s: float


@dataclass(frozen=True, kw_only=True)
class ProbeProduct(Product):
    """Of all videos together."""

    n_frames: int
    width: int
    """Of a frame as shown, px."""
    height: int
    average_rate: str
    """Frames per second of the first video, as "num/den"."""
    duration_s: float
    truncated: bool
    flags: tuple[Flag, ...]
    videos: tuple[VideoLength, ...] | None = field(default=None, metadata=OMITTED)
    """Of each where there are several."""


@dataclass(frozen=True, kw_only=True)
class AnnotationsProduct(Product):
    """Of all annotation files together."""

    format: str = ""
    """Empty in results of 0.2.0 and before."""
    n_detections: int
    n_keys: int
    n_annotated_frames: int
    n_without_frame: int
    """Detections whose key is no frame's."""
    labels: Mapping[str, int]
    """Detections by label."""
    warnings: tuple[str, ...]
    time_convention: JsonObject
    """How the keys were read (`core.annotations.convention.Fitted.to_dict`)."""
    flags: tuple[Flag, ...]
    time_conventions: tuple[JsonObject, ...] | None = field(default=None, metadata=OMITTED)
    """Of each file where there are several videos."""


@dataclass(frozen=True, kw_only=True)
class FramesProduct(Product):
    """Of the frames that take part."""

    n_frames: int
    n_damaged: int = 0
    """Frames whose picture is damaged; not counted in 0.2.0 and before."""
    n_search: int
    """Frames of the search: those from this index on are out of order."""
    crop: tuple[int, int, int, int]
    """(x0, y0, x1, y1) of the used region in source pixels, half open."""
    source_width: int
    source_height: int
    still_share: float
    flags: tuple[Flag, ...]


@dataclass(frozen=True, kw_only=True)
class PicturesProduct(Product):
    """Of the published pictures."""

    n_pictures: int


@dataclass(frozen=True, kw_only=True)
class FeaturesProduct(Product):
    """Of one chunk of frames."""

    n_images: int
    min_keypoints: int
    mean_keypoints: float


@dataclass(frozen=True, kw_only=True)
class MotionProduct(Product):
    """Of the keyframes."""

    n_keyframes: int
    median_step: float
    """Frames from one keyframe to the next."""
    motion_per_frame: float | None
    """Share of the width; None where it was never measured."""


# Members of the next two stand in the order of the alphabet, in which ``camera.json`` has them.
@dataclass(frozen=True, kw_only=True)
class FocalSpan:
    """What one span of keyframes says of the lens; 0 registered images without a model."""

    end: int
    focal_px: float
    frames: int
    """Keyframes in it."""
    k1: float
    mean_reprojection_error_px: float
    points3D: int  # noqa: N815 (COLMAP's and the contract's name)
    registered_images: int
    start: int


@dataclass(frozen=True, kw_only=True)
class FocalProduct(Product):
    """What the spans of one start say of the lens together."""

    focal_px: float
    fov_deg: float
    """Field of view that it started from."""
    frames: int
    """Keyframes offered."""
    k1: float
    mean_reprojection_error_px: float
    model: str
    """COLMAP's name of the lens's model that it was asked as."""
    points3D: int  # noqa: N815 (COLMAP's and the contract's name)
    registered: int
    spans: tuple[FocalSpan, ...]


class FocalSource(StrEnum):
    """Where the focal length that mapping starts from comes from."""

    CALIBRATION = "calibration"
    GIVEN = "given"
    """The field of view that the settings name."""
    ESTIMATED = "estimated"
    """The starts of `FocalProduct`."""
    COLMAP = "colmap"
    """COLMAP's default, 1.2 times the longer side of the crop."""


@dataclass(frozen=True, kw_only=True)
class CameraProduct(Product):
    """The lens that mapping starts from, and the starts it was chosen from: the content of ``camera.json``."""

    model: str
    width: int
    """Of the crop, px."""
    height: int
    params: tuple[float, ...]
    """In COLMAP's order."""
    focal_from: FocalSource
    reason: str
    """Code that says why an estimate was asked for and not used; else empty."""
    chosen_start_deg: float | None
    agreement: float | None
    """Share of the starts that ended near the chosen focal length."""
    starts: tuple[FocalProduct, ...]
    other_starts: tuple[FocalProduct, ...] = ()
    """Those of another model of the lens, of which none was chosen."""
    flags: tuple[Flag, ...]


@dataclass(frozen=True, kw_only=True)
class MatchesProduct(Product):
    """Counts of a table of pairs."""

    n_pairs: int
    n_verified: int
    n_lightglue: int
    n_inliers: int


@dataclass(frozen=True, kw_only=True)
class BridgeProduct(MatchesProduct):
    """Counts of the further pairs, and where the sequence is broken, as (last frame before, first frame after)."""

    gaps: tuple[tuple[int, int], ...]
    jumps: tuple[tuple[int, int], ...]
    dropped: int
    """Pairs over a jump, which are left out."""
    spanned: tuple[tuple[int, int], ...]
    """Gaps that a believed pair reaches over."""
    largest_piece: int
    """Frames of the largest component."""
    flags: tuple[Flag, ...]


@dataclass(frozen=True, kw_only=True)
class GraphProduct(Product):
    """Counts of a view graph."""

    n_pairs: int
    n_verified: int
    largest_component: int
    """Frames that verified pairs join."""
    median_triangulation_angle_deg: float
