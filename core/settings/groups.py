"""The algorithm options, grouped by what they govern; those of the input are in `core.settings.reading`.

Defaults here are the preset `default`.
"""

from __future__ import annotations

from typing import Literal, Self

from pydantic import model_validator

from core.geometry.lens import LensModel, check_told
from core.settings.base import Group, option

MAX_PERSPECTIVE_FOV_DEG = 170.0
"""A perspective lens maps 180 degrees to infinity."""


class FrameSettings(Group):
    """Which frames of the video take part."""

    clip_start_s: float | None = option(
        None, "start of the used interval; none = first frame", unit="s", source="thesis uses 2.0", ge=0
    )
    clip_end_s: float | None = option(
        None, "end of the used interval; none = last frame", unit="s", source="thesis uses 121.0", gt=0
    )
    count: int = option(450, "frames sampled evenly over the interval, at most", unit="frames", source="thesis", ge=2)
    include_annotated: bool = option(True, "add every frame that carries a detection", source="coverage")
    max_count: int = option(
        600, "sampled and annotated frames of the search together, at most", unit="frames", source="time budget", ge=2
    )
    neighbour_s: float = option(
        0.5,
        "an annotated frame gets a neighbour on each side within this time, as far as max_count goes; 0 adds none",
        unit="s",
        source="coverage",
        ge=0,
    )
    time_rule: Literal["pts", "average_rate"] = option(
        "pts", "frame of a clip time: nearest presentation time, or time x average rate", source="exact times"
    )
    mask_still: bool = option(
        True, "no keypoints on what never moves in the picture: burned-in text, dirt on the lens", source="method"
    )
    jpeg_quality: int = option(95, "quality of the exported frames", unit="%", source="OpenCV default", ge=50, le=100)


class RoiSettings(Group):
    """Region of interest, normalised on the source frame."""

    x0: float = option(0.04, "left edge", unit="share of width", source="thesis", ge=0, le=1)
    y0: float = option(0.11, "upper edge", unit="share of height", source="thesis", ge=0, le=1)
    x1: float = option(0.86, "right edge", unit="share of width", source="thesis", ge=0, le=1)
    y1: float = option(0.84, "lower edge", unit="share of height", source="thesis", ge=0, le=1)


class CameraSettings(Group):
    """The lens: its model, and where it starts or what it is. All frames share one camera."""

    model: Literal["OPENCV_FISHEYE", "OPENCV", "PINHOLE", "SIMPLE_RADIAL"] = option(
        "OPENCV_FISHEYE", "COLMAP's model of the lens", source="thesis"
    )
    params: tuple[float, ...] | None = option(
        None,
        "what a calibration says of the lens: parameters of camera.model in COLMAP's order for the whole source frame, "
        "pixel centres at 0.5; the lens is then held (`--calibration FILE` sets it)",
        unit="px, rest without unit",
        source="user",
    )
    size_px: tuple[int, int] | None = option(
        None,
        "width and height of the picture that camera.params belong to; those of the video may differ by one factor",
        unit="px",
        source="user",
    )
    fov_deg: float | None = option(
        None, "horizontal field of view of the source frame, when known", unit="deg", source="user", gt=5, lt=220
    )
    focal: Literal["estimate", "colmap"] = option(
        "estimate",
        "without a field of view: estimate it, or start at COLMAP's 1.2 x longer side",
        source="method",
    )
    fov_starts_deg: tuple[float, ...] = option(
        (40.0, 55.0, 70.0, 85.0, 100.0, 120.0),
        "horizontal fields of view tried by the estimate",
        unit="deg",
        source="borescopes: 40-120 degrees",
    )
    focal_span: int = option(30, "frames in each span the estimate maps", unit="frames", source="measured", ge=8)
    focal_spans: int = option(2, "spans the estimate maps for every start", source="measured", ge=1, le=8)
    principal_point: Literal["source", "crop"] = option(
        "source",
        "principal point: source frame's centre minus crop offset, or the crop's centre",
        source="method",
    )

    @model_validator(mode="after")
    def _agrees(self) -> Self:
        """What is said of the lens says one thing, and a lens that can be."""
        if (self.params is None) != (self.size_px is None):
            raise ValueError("camera.params and camera.size_px are given together or not at all")
        if self.fov_deg is not None and self.params is not None:
            raise ValueError("camera.fov_deg and camera.params both say what the lens is; give one of them")
        fisheye = self.model == LensModel.OPENCV_FISHEYE
        if self.fov_deg is not None and self.fov_deg >= MAX_PERSPECTIVE_FOV_DEG and not fisheye:
            reach = f"{MAX_PERSPECTIVE_FOV_DEG:g} degrees"
            raise ValueError(f"camera.fov_deg is {self.fov_deg:g}; a {self.model} lens sees less than {reach}")
        if self.params is not None and self.size_px is not None:
            check_told(self.model, self.params, self.size_px)
        return self


class FeatureSettings(Group):
    """Keypoints and descriptors."""

    method: Literal["disk", "sift"] = option("disk", "detector and descriptor", source="thesis")
    max_keypoints: int = option(5000, "keypoints per frame, at most", source="thesis", ge=64)
    max_size_px: int = option(
        1600, "longer side above which frames are scaled down (never up)", unit="px", source="thesis", ge=64
    )
    scale: float = option(1.0, "further scale of the frame before detection", source="draft uses 0.5", gt=0, le=1)
    subpixel: bool = option(
        True, "DISK: refine keypoints by a parabola through the heat map", source="measured; thesis off"
    )
    blade_masks_only: bool = option(False, "drop keypoints outside the annotated blade masks", source="off")


class MatchSettings(Group):
    """Pairs and how they are matched."""

    method: Literal["mutual_nearest", "lightglue", "auto"] = option(
        "auto",
        "mutual nearest neighbours, LightGlue, or LightGlue only where verification is weak",
        source="method",
    )
    window: int = option(
        5, "each frame is paired with this many following frames", unit="frames", source="thesis", ge=1
    )
    keyframes: bool = option(
        True,
        "on a slow clip also pair keyframes, chosen by motion of the picture, and seek the focal length on these",
        source="decision 19; thesis off",
    )
    bridge: bool = option(
        True, "seek pairs beyond the window where the sequence is thin: a dark stretch, a jump", source="method"
    )
    ratio: float = option(
        1.0, "mutual nearest: distance ratio first / second must be below; 1 = no test", source="measured", gt=0, le=1
    )
    auto_min_inliers: int = option(
        100, "auto: fewer verified inliers than this call for LightGlue", source="measured", ge=0
    )
    auto_keypoints: int = option(
        2048, "auto: LightGlue takes this many of the strongest keypoints", source="measured", ge=64
    )
    auto_min_inlier_share: float = option(
        0.25, "auto: a smaller share of verified matches calls for LightGlue", source="measured", ge=0, le=1
    )


class VerificationSettings(Group):
    """Two-view geometric verification."""

    max_error_px: float = option(1.5, "RANSAC inlier threshold", unit="px", source="thesis 4.0; measured", gt=0)
    min_inliers: int = option(15, "inliers below which a pair is dropped", source="COLMAP", ge=8)
    min_inlier_share: float = option(
        0.1,
        "share of the matches below which a pair is dropped: chance alone reaches a few percent",
        source="measured; COLMAP 0",
        ge=0,
        le=1,
    )


class WindowSettings(Group):
    """Windows over the frame sequence; each window is one reconstruction case."""

    mode: Literal["search", "single"] = option("search", "coarse and refined windows, or one window", source="thesis")
    coarse_length: int = option(180, "coarse window", unit="frames", source="thesis", ge=3)
    coarse_step: int = option(20, "step of coarse windows", unit="frames", source="thesis", ge=1)
    coarse_min: int = option(30, "shorter coarse windows are dropped", unit="frames", source="thesis", ge=3)
    refine_margin: int = option(80, "best coarse interval is widened by", unit="frames", source="thesis", ge=0)
    refine_length: int = option(220, "refined window", unit="frames", source="thesis", ge=3)
    refine_step: int = option(10, "step of refined windows", unit="frames", source="thesis", ge=1)
    refine_min: int = option(60, "shorter refined windows are dropped", unit="frames", source="thesis", ge=3)
    start: Literal["scratch", "warm"] = option(
        "warm", "cases start from scratch, or from the model of a case named by the plan", source="decision 6"
    )
    anchor_step: int = option(
        60,
        "warm: windows that start at multiples of this map from scratch",
        unit="frames",
        source="decision 6",
        ge=1,
    )


class MapperSettings(Group):
    """COLMAP's incremental mapper."""

    min_model_size: int = option(3, "smallest model kept", unit="images", source="thesis", ge=2)
    init_min_num_inliers: int = option(40, "inliers of the initial pair", source="thesis", ge=6)
    abs_pose_min_num_inliers: int = option(20, "inliers to register an image", source="thesis", ge=6)
    abs_pose_min_inlier_ratio: float = option(0.10, "inlier share to register an image", source="thesis", ge=0, le=1)
    initial_pair: Literal["graph", "colmap"] = option(
        "graph", "initial pair from the verified graph, or COLMAP's own search", source="decision 6"
    )
    bundle_adjustment: Literal["tuned", "colmap"] = option(
        "tuned", "bundle adjustment during the window search", source="decision 6"
    )
    refine_distortion: bool = option(
        False, "free the distortion while a model grows; the last adjustment frees it in any case", source="measured"
    )
    refine_lens: bool = option(
        True,
        "free the lens while a model grows and at the end; false holds it as it was told, and is the default with "
        "camera.params",
        source="method",
    )
    search_tracks: int = option(
        400, "keypoints per image that take part in the search, longest tracks first; 0 = all", source="measured", ge=0
    )


class ModelSettings(Group):
    """From the winning case to the final model."""

    veto: bool = option(
        True, "a model that a check calls wrong cannot win; all such = no reconstruction", source="checks; thesis off"
    )
    prefer_verified: bool = option(
        True,
        "of trusted cases the one that verifies more detections wins, then the larger",
        source="method; thesis off",
    )
    further: int = option(
        2,
        "further models of frames that cannot be joined to the first, at most",
        unit="models",
        source="method",
        ge=0,
        le=8,
    )
    confirm: bool = option(
        True, "map a winner that started warm again from scratch, with COLMAP's bundle adjustment", source="decision 6"
    )
    register_rest: bool = option(True, "go on mapping over all remaining frames", source="method")
    join: bool = option(True, "join what is left over through images that both models have", source="method")
    drop_loose: bool = option(
        True, "take off what hangs on the model by hardly any points", source="measured; thesis off"
    )
    final_adjustment: bool = option(True, "finish with a converged bundle adjustment", source="measured")
    align_keypoints: bool = option(
        True, "move the keypoints of a track to the same spot of the metal", source="decision 14; thesis off"
    )
    trim_tracks: bool = option(
        True, "cameras and lens follow from the tracks that agree best, not from all", source="decision 13; thesis off"
    )
    radial_terms: Literal["auto", "always"] = option(
        "auto", "auto: as many as the tracks that agree best ask for", source="decision 15"
    )
    loss_scale_px: float = option(
        0.0,
        "last adjustment: residuals above this count less (Cauchy); 0 counts squares",
        unit="px",
        source="measured: 1.0 takes 0.038 to 0.034 mm at five times the time",
        ge=0,
    )
    refine_principal_point: Literal["auto", "never"] = option(
        "auto", "free the principal point in the last adjustment when it is well determined", source="measured"
    )


class DenseSettings(Group):
    """Depth maps."""

    method: Literal["auto", "cpu", "cuda"] = option(
        "auto", "own PatchMatch on the CPU, COLMAP's on CUDA, or CUDA where pycolmap has it", source="method"
    )
    views: int = option(60, "depth maps, spread over the model; 0 = every registered image", source="time budget", ge=0)
    sources: int = option(5, "source images per depth map", source="measured: 4-6; thesis 20", ge=1, le=50)
    max_image_size_px: int = option(2000, "longer side of undistorted images", unit="px", source="thesis", ge=64)
    scale: float = option(1.0, "further scale of undistorted images", source="draft uses 0.5", gt=0, le=1)
    max_stretch: float = option(
        2.0, "radial stretch of the lens's border by undistortion, at most (2 = 45 degrees)", source="measured", gt=1
    )
    levels: int = option(3, "image scales, coarse to fine", source="decision 7", ge=1, le=5)
    iterations: int = option(2, "red-black sweeps per scale", source="measured: more find false minima", ge=1, le=10)
    best_views: int = option(2, "cost is the mean over this many best source views", source="decision 7", ge=1, le=10)
    geometric_passes: int = option(1, "passes with geometric consistency", source="decision 7", ge=0, le=3)
    min_ncc: float = option(0.3, "estimates correlating less are dropped", source="measured", ge=-1, le=1)
    min_triangulation_deg: float = option(
        3.0, "estimates seen under a smaller angle are dropped", unit="deg", source="COLMAP", ge=0
    )
    min_consistent: int = option(2, "source views that must agree", source="COLMAP", ge=0)


class FusionSettings(Group):
    """Fusion of depth maps into one point cloud (COLMAP)."""

    min_num_pixels: int = option(
        2, "pixels per fused point, at least", source="each is confirmed by two views already; COLMAP 5", ge=1
    )
    max_reproj_error_px: float = option(2.0, "reprojection error of fused pixels", unit="px", source="COLMAP", gt=0)
    max_depth_error: float = option(0.01, "relative depth difference of fused pixels", source="COLMAP", gt=0)
    max_normal_error_deg: float = option(
        40.0,
        "angle between normals of fused pixels",
        unit="deg",
        source="measured; COLMAP 10",
        gt=0,
    )


class MeshSettings(Group):
    """Surface from the cloud (COLMAP's Poisson)."""

    poisson_depth: int = option(10, "octree depth", source="metrics; COLMAP 13", ge=4, le=14)
    poisson_trim: float = option(6.0, "Poisson's own trimming, in octree depth", source="metrics; COLMAP 10", ge=0)
    keep_unsupported: bool = option(False, "map on the full Poisson surface", source="thesis: on")
    support_spacings: float = option(
        5.0, "farther from the cloud than this many median point spacings is not supported", source="measured", gt=0
    )
    keep_largest_component: bool = option(False, "keep only the largest connected part", source="thesis: off")


class MappingSettings(Group):
    """Detections onto the surface."""

    method: Literal["surface", "thesis"] = option(
        "surface",
        "cast onto the supported surface and ask other views, or the thesis's sparse support",
        source="method",
    )
    box_frame: Literal["source", "crop"] = option(
        "source", "frame in which boxes are normalised (crop repeats the thesis's reading)", source="method"
    )
    time_rule: Literal["pts", "average_rate"] = option(
        "pts", "time of a frame: presentation time, or index / average rate", source="method"
    )
    time_tolerance_s: float = option(
        0.4,
        "a registered image that gives a detection its place is nearer in time than this: the nearest one (thesis), or "
        "both neighbours of an interpolated pose (surface)",
        unit="s",
        source="thesis",
        gt=0,
    )
    radius_fraction: float = option(0.01, "colouring radius / mesh diagonal (eq. 3.1)", source="thesis", gt=0, le=1)
    sigma_fraction: float = option(0.35, "sigma / colouring radius (eq. 3.2)", source="thesis", gt=0)


class TimelineSettings(Group):
    """Events and clusters."""

    radius_fraction: float = option(0.02, "cluster radius / mesh diagonal (eq. 3.3)", source="thesis", gt=0, le=1)
    occlusion_fraction: float = option(
        0.01, "surface this much before a place / mesh diagonal does not hide it", source="colouring radius", ge=0, le=1
    )


class GallerySettings(Group):
    """Pictures for people."""

    max_frames: int = option(200, "frames with boxes, at most", unit="frames", source="size of the page", ge=1)
    jpeg_quality: int = option(88, "quality of the pictures", unit="%", source="size of the page", ge=50, le=100)
    render_width_px: int = option(1600, "width of the two views of the surface", unit="px", source="page", ge=64)
    render_height_px: int = option(1200, "height of the two views of the surface", unit="px", source="page", ge=64)


class ComputeSettings(Group):
    """Work, not method: none of these is meant to change what is found."""

    threads: int = option(
        0,
        "threads of stages that are not fanned out; 0 = all cores, yet one where only one repeats exactly",
        source="machine",
        ge=0,
    )
    chunk_frames: int = option(48, "frames per task of features and matches", unit="frames", source="measured", ge=1)
    chunk_views: int = option(8, "depth maps per task", unit="views", source="measured", ge=1)
