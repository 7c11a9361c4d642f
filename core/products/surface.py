"""Products of the stages behind the final model: surface, row of blades, places, defects and pages."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from core.flags import Flag
from core.json_files import JsonObject
from core.products.contract import OMITTED, Product


@dataclass(frozen=True, kw_only=True)
class UndistortProduct(Product):
    """Of the pinhole views."""

    n_views: int
    """Views that get a depth map."""
    n_images: int
    """Those and their sources."""
    width: int
    height: int
    focal_px: float


@dataclass(frozen=True, kw_only=True)
class DepthProduct(Product):
    """Of one chunk of depth maps, before or after geometric consistency."""

    n_views: int
    valid_share: float
    method: str
    """``cpu`` or ``cuda``."""


@dataclass(frozen=True, kw_only=True)
class FuseProduct(Product):
    """Of the fused cloud."""

    n_points: int
    method: str
    """Of its depth maps, joined by "+"."""


@dataclass(frozen=True, kw_only=True)
class MeshProduct(Product):
    """Of the surface; also the content of ``mesh.json``."""

    n_vertices: int
    """Of the supported part."""
    n_faces: int
    n_full_vertices: int
    n_full_faces: int
    diagonal_su: float
    point_spacing_su: float
    supported_share: float


@dataclass(frozen=True, kw_only=True)
class RowProduct(Product):
    """Whether the motion between views looks like the turn of a row."""

    pitch_rad: float | None
    reason: str | None
    """Code that says why there is no pitch."""


@dataclass(frozen=True, kw_only=True)
class BladesProduct(Product):
    """The blades of the row that were told apart."""

    n_blades: int
    reason: str | None
    """Code that says why there are none."""
    flags: tuple[Flag, ...] = ()


@dataclass(frozen=True, kw_only=True)
class PlacesProduct(Product):
    """What became of the detections."""

    n_detections: int
    outcomes: Mapping[str, int]
    reasons: Mapping[str, int]
    support_min: int | None
    """Sparse points of a mapped detection; None without any."""
    support_mean: float | None
    support_max: int | None
    unique_support_points: int


@dataclass(frozen=True, kw_only=True)
class TimelineProduct(Product):
    """Defects and events of one model; what only one of the two methods counts is omitted by the other."""

    n_events: int
    n_defects: int
    n_unconfirmed: int | None = field(default=None, metadata=OMITTED)
    n_measured: int | None = field(default=None, metadata=OMITTED)
    scale: JsonObject | None = field(default=None, metadata=OMITTED)
    """`core.scene.size.scale_fields`."""
    flags: tuple[Flag, ...] | None = field(default=None, metadata=OMITTED)
    cluster_radius_su: float | None = field(default=None, metadata=OMITTED)


@dataclass(frozen=True, kw_only=True)
class ViewerProduct(Product):
    """Of the page's surface."""

    n_faces: int
    glb_bytes: int


@dataclass(frozen=True, kw_only=True)
class GalleryProduct(Product):
    """Of the gallery."""

    n_images: int
    """Frames shown with their boxes."""
    n_frames: int
    """Frames with a detection."""
