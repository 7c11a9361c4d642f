"""What every kind of task is: its version, its product, the settings it reads, where it may run, what it weighs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from core.products.contract import Product
from core.products.front import (
    AnnotationsProduct,
    BridgeProduct,
    CameraProduct,
    FeaturesProduct,
    FocalProduct,
    FramesProduct,
    GraphProduct,
    MatchesProduct,
    MotionProduct,
    PicturesProduct,
    ProbeProduct,
)
from core.products.search import (
    CaseProduct,
    ChoiceProduct,
    ConfirmProduct,
    ExtendProduct,
    PassedProduct,
    PruneProduct,
    ReducerProduct,
    RefinedProduct,
    ReverifyProduct,
    SubmodelsProduct,
)
from core.products.surface import (
    BladesProduct,
    DepthProduct,
    FuseProduct,
    GalleryProduct,
    MeshProduct,
    PlacesProduct,
    RowProduct,
    TimelineProduct,
    UndistortProduct,
    ViewerProduct,
)
from core.states import Queue
from core.weight_files import DISK_WEIGHTS, LIGHTGLUE_WEIGHTS

USUAL_CORES, USUAL_FRAMES = 2, 96
"""Of the run whose stages were timed: the sample (docs/operations/scaling.md). Of a stage that it did not need, the
weight is an estimate."""


@dataclass(frozen=True)
class StageSpec:
    """A kind of task: its code and product, what of the settings it reads, where it may run."""

    name: str
    version: int
    entry: str
    """``module:function`` of the stage; a string, so that the graph loads no vision library."""
    product: type[Product]
    """What it hands on beside its files: `run` returns this type, or one of it."""
    settings: tuple[str, ...]
    """Groups or single dotted options that the stage reads: exactly these enter its fingerprint."""
    fan_out: bool = False
    """Many tasks of this stage run side by side, so each uses one thread."""
    queue: Queue = Queue.CPU
    weight: float = 1.0
    """Seconds of the clock, process and files included, on `USUAL_CORES` cores for `USUAL_FRAMES` frames: progress
    follows them, and so does the time left before anything is learnt."""
    per_frame: bool = False
    """The weight grows with the number of frames."""
    reads_video: bool = False
    reads_annotations: bool = False
    weights: tuple[str, ...] = ()
    """Files of learnt weights that the stage uses; their hashes enter its fingerprint."""


def _spec(name: str, product: type[Product], *settings: str, version: int = 1, **more: Any) -> StageSpec:
    return StageSpec(name, version, f"core.stages.{name}:run", product, settings, **more)


def _options(group: str, *names: str) -> tuple[str, ...]:
    return tuple(f"{group}.{name}" for name in names)


_MATCHER = (
    *_options("matching", "method", "ratio", "auto_min_inliers", "auto_keypoints", "auto_min_inlier_share"),
    "features.method",
    "verification",
    "seed",
)

_LENS = _options("camera", "model", "params", "size_px", "fov_deg", "focal", "principal_point")

STAGES: dict[str, StageSpec] = {
    spec.name: spec
    for spec in (
        _spec(
            "probe",
            ProbeProduct,
            *_options("input", "allow_truncated", "video_stream", "fps"),
            version=3,
            reads_video=True,
            weight=1.4,
        ),
        _spec(
            "annotations",
            AnnotationsProduct,
            *_options("input", "time_convention", "annotation_format"),
            version=4,
            reads_annotations=True,
            weight=0.7,
        ),
        _spec(
            "frames",
            FramesProduct,
            "frames",
            "roi",
            "overrides",
            version=3,
            reads_video=True,
            weight=5.3,
            per_frame=True,
        ),
        _spec("pictures", PicturesProduct, reads_video=True, weight=2.7, per_frame=True),
        _spec(
            "features",
            FeaturesProduct,
            "features",
            version=3,
            fan_out=True,
            weight=22,
            per_frame=True,
            weights=(DISK_WEIGHTS,),
        ),
        _spec("motion", MotionProduct, weight=2.3, per_frame=True),
        _spec(
            "focal",
            FocalProduct,
            *_options("camera", "model", "principal_point", "focal_span", "focal_spans"),
            *_options("mapper", "min_model_size", "init_min_num_inliers"),
            *_options("mapper", "abs_pose_min_num_inliers", "abs_pose_min_inlier_ratio"),
            "matching.ratio",
            "verification",
            "seed",
            version=4,
            fan_out=True,
            weight=32,
        ),
        _spec("camera", CameraProduct, *_LENS, version=4, weight=0.5),
        _spec(
            "matches",
            MatchesProduct,
            *_MATCHER,
            "matching.window",
            version=4,
            fan_out=True,
            weight=12,
            per_frame=True,
            weights=(LIGHTGLUE_WEIGHTS,),
        ),
        _spec("bridge", BridgeProduct, *_MATCHER, version=3, weight=1.3, per_frame=True, weights=(LIGHTGLUE_WEIGHTS,)),
        _spec("graph", GraphProduct, weight=1.1, per_frame=True),
        _spec("coarse", CaseProduct, "mapper", "seed", version=3, fan_out=True, weight=12, per_frame=True),
        _spec("reduce_coarse", ChoiceProduct, "model.veto", version=2, weight=0.6),
        _spec("refine", CaseProduct, "mapper", "seed", version=3, fan_out=True, weight=12, per_frame=True),
        _spec("reduce_refine", RefinedProduct, "model.veto", "model.prefer_verified", version=4, weight=0.9),
        _spec("prune", PruneProduct, weight=0.6),
        _spec("section", CaseProduct, "mapper", "seed", fan_out=True, weight=1, per_frame=True),
        _spec("reduce_parts", ReducerProduct, "model.prefer_verified", version=2, weight=0.6),
        _spec("reverify", ReverifyProduct, *_LENS, "verification", "seed", version=2, weight=0.8, per_frame=True),
        _spec("perspective", CaseProduct, "mapper", "seed", weight=1, per_frame=True),
        _spec("reduce_perspective", PassedProduct, weight=0.6),
        _spec(
            "confirm",
            ConfirmProduct,
            "mapper",
            "model.confirm",
            "model.veto",
            "seed",
            version=4,
            weight=1.5,
            per_frame=True,
        ),
        _spec(
            "extend",
            ExtendProduct,
            "mapper",
            *_options("model", "veto", "register_rest", "join", "drop_loose", "final_adjustment", "align_keypoints"),
            *_options("model", "trim_tracks", "radial_terms", "loss_scale_px", "refine_principal_point"),
            "seed",
            "compute.threads",
            version=14,
            weight=63,
            per_frame=True,
        ),
        _spec("pieces", SubmodelsProduct, "mapper", "model.further", "seed", weight=1.6),
        _spec(
            "undistort",
            UndistortProduct,
            *_options("dense", "method", "views", "sources", "max_image_size_px", "scale", "max_stretch"),
            weight=2.4,
        ),
        _spec(
            "depth",
            DepthProduct,
            *_options("dense", "method", "levels", "iterations", "best_views"),
            *_options("dense", "min_ncc", "min_triangulation_deg", "min_consistent"),
            "seed",
            version=2,
            fan_out=True,
            queue=Queue.GPU,
            weight=60,
        ),
        _spec(
            "geometric",
            DepthProduct,
            *_options("dense", "method", "iterations", "best_views", "geometric_passes"),
            *_options("dense", "min_ncc", "min_triangulation_deg", "min_consistent"),
            "seed",
            version=2,
            fan_out=True,
            queue=Queue.GPU,
            weight=67,
        ),
        _spec("fuse", FuseProduct, "fusion", weight=19),
        _spec("mesh", MeshProduct, "mesh", weight=62),
        _spec("row", RowProduct, "seed", version=5, weight=3),
        _spec(
            "blades",
            BladesProduct,
            *_options("row", "count", "zero_blade", "direction", "edge_a", "same_blade"),
            "seed",
            version=9,
            weight=1,
        ),
        _spec("map_defects", PlacesProduct, "mapping", version=12, weight=0.6),
        _spec(
            "timeline",
            TimelineProduct,
            *_options("mapping", "method", "radius_fraction", "sigma_fraction"),
            "timeline",
            "scale",
            *_options("row", "radius_mm", "radius_sigma_mm", "radius_at"),
            version=13,
            weight=7.7,
        ),
        _spec("gallery", GalleryProduct, "gallery", "mapping.method", version=7, reads_video=True, weight=29),
        _spec("viewer", ViewerProduct, version=7, weight=29, per_frame=True),
    )
}
