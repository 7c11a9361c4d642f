"""What every kind of task is: its version, the settings that it reads, where it may run, and what it weighs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from core.states import Queue
from core.weight_files import DISK_WEIGHTS, LIGHTGLUE_WEIGHTS


@dataclass(frozen=True)
class StageSpec:
    """A kind of task: its code, what of the settings it reads, where it may run."""

    name: str
    version: int
    entry: str
    """``module:function`` of the stage; a string, so that the graph loads no vision library."""
    settings: tuple[str, ...]
    """Groups or single dotted options that the stage reads: exactly these enter its fingerprint."""
    fan_out: bool = False
    """Many tasks of this stage run side by side, so each uses one thread."""
    queue: Queue = Queue.CPU
    weight: float = 1.0
    """Rough share of the run's time, for progress before anything is learnt: 10 s of two cores each."""
    reads_video: bool = False
    reads_annotations: bool = False
    weights: tuple[str, ...] = ()
    """Files of learnt weights that the stage uses; their hashes enter its fingerprint."""


def _spec(name: str, *settings: str, version: int = 1, **more: Any) -> StageSpec:
    return StageSpec(name, version, f"core.stages.{name}:run", settings, **more)


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
            *_options("input", "allow_truncated", "video_stream", "fps"),
            version=3,
            reads_video=True,
            weight=0.2,
        ),
        _spec(
            "annotations",
            *_options("input", "time_convention", "annotation_format"),
            version=4,
            reads_annotations=True,
            weight=0.1,
        ),
        _spec("frames", "frames", "roi", "overrides", version=3, reads_video=True, weight=0.3),
        _spec("pictures", reads_video=True, weight=0.3),
        _spec("features", "features", version=3, fan_out=True, weight=26, weights=(DISK_WEIGHTS,)),
        _spec("motion", weight=0.4),
        _spec(
            "focal",
            *_options("camera", "model", "principal_point", "focal_span", "focal_spans"),
            *_options("mapper", "min_model_size", "init_min_num_inliers"),
            *_options("mapper", "abs_pose_min_num_inliers", "abs_pose_min_inlier_ratio"),
            "matching.ratio",
            "verification",
            "seed",
            version=4,
            fan_out=True,
            weight=7,
        ),
        _spec("camera", *_LENS, version=4, weight=0.1),
        _spec(
            "matches", *_MATCHER, "matching.window", version=4, fan_out=True, weight=45, weights=(LIGHTGLUE_WEIGHTS,)
        ),
        _spec("bridge", *_MATCHER, version=3, weight=1, weights=(LIGHTGLUE_WEIGHTS,)),
        _spec("graph", weight=0.3),
        _spec("coarse", "mapper", "seed", version=3, fan_out=True, weight=25),
        _spec("reduce_coarse", "model.veto", version=2, weight=0.1),
        _spec("refine", "mapper", "seed", version=3, fan_out=True, weight=21),
        _spec("reduce_refine", "model.veto", "model.prefer_verified", version=4, weight=0.1),
        _spec("prune", weight=0.1),
        _spec("section", "mapper", "seed", fan_out=True, weight=0.5),
        _spec("reduce_parts", "model.prefer_verified", version=2, weight=0.1),
        _spec("reverify", *_LENS, "verification", "seed", version=2, weight=0.3),
        _spec("perspective", "mapper", "seed", weight=0.5),
        _spec("reduce_perspective", weight=0.1),
        _spec("confirm", "mapper", "model.confirm", "model.veto", "seed", version=4, weight=6),
        _spec(
            "extend",
            "mapper",
            *_options("model", "veto", "register_rest", "join", "drop_loose", "final_adjustment", "align_keypoints"),
            *_options("model", "trim_tracks", "radial_terms", "loss_scale_px", "refine_principal_point"),
            "seed",
            "compute.threads",
            version=13,
            weight=18,
        ),
        _spec("pieces", "mapper", "model.further", "seed", weight=0.5),
        _spec(
            "undistort",
            *_options("dense", "method", "views", "sources", "max_image_size_px", "scale", "max_stretch"),
            weight=1,
        ),
        _spec(
            "depth",
            *_options("dense", "method", "levels", "iterations", "best_views"),
            *_options("dense", "min_ncc", "min_triangulation_deg", "min_consistent"),
            "seed",
            version=2,
            fan_out=True,
            queue=Queue.GPU,
            weight=24,
        ),
        _spec(
            "geometric",
            *_options("dense", "method", "iterations", "best_views", "geometric_passes"),
            *_options("dense", "min_ncc", "min_triangulation_deg", "min_consistent"),
            "seed",
            version=2,
            fan_out=True,
            queue=Queue.GPU,
            weight=21,
        ),
        _spec("fuse", "fusion", weight=3),
        _spec("mesh", "mesh", weight=2),
        _spec("row", "seed", version=3, weight=3),
        _spec("blades", *_options("row", "count", "zero_blade", "direction", "edge_a"), "seed", version=4, weight=1),
        _spec("map_defects", "mapping", version=11, weight=0.6),
        _spec(
            "timeline",
            *_options("mapping", "method", "radius_fraction", "sigma_fraction"),
            "timeline",
            "scale",
            *_options("row", "radius_mm", "radius_sigma_mm", "radius_at"),
            version=11,
            weight=0.5,
        ),
        _spec("gallery", "gallery", "mapping.method", version=7, reads_video=True, weight=1),
        _spec("viewer", version=5, weight=2),
    )
}
