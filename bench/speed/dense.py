"""Depth maps: this project's PatchMatch against OpenCV's semi-global matching on rectified pairs.

Semi-global matching sees one source image at a time; it gets as many as PatchMatch, and its maps are joined
by the median. Both are held against the sparse points that the view observes, which neither has seen as
an answer: PatchMatch starts from them, on a scale four times coarser.
"""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import ArrayLike, NDArray

from bench.speed.finished import FinishedRun
from bench.speed.timing import Row, Table, interleaved
from core.dense.cameras import Pinhole
from core.dense.maps import DenseScene, open_scene
from core.dense.stereo import PhotometricStereo
from core.dense.views import DenseView
from core.geometry.pose import Pose

SOURCES = 4
NEAR = 0.01
"""A depth within this share of the sparse point's is right."""
NO_DISTORTION = np.zeros(5)
F32 = NDArray[np.float32]


def compare(run: FinishedRun, *, threads: int, repeat: int, n_views: int = 3) -> Table:
    """Depth maps of views spread over the model; the compilation of kernels is not timed."""
    scene = open_scene(run.folder("undistort"))
    chosen = [scene.views[i] for i in np.linspace(0, len(scene.views) - 1, n_views).astype(int)]
    views = [DenseView(v.name, v.index, v.sources[:SOURCES], v.depth_min, v.depth_max) for v in chosen]
    settings = run.settings.dense
    stereo = PhotometricStereo(scene, settings, run.settings.seed, threads)
    cv2.setNumThreads(threads)
    maps = {
        "ours": [stereo.depth_map(view).depth for view in views],
        "sgbm": [semi_global(scene, view) for view in views],
    }
    times = interleaved(
        {
            # A new object each time: pyramids are part of the work.
            "ours": lambda: [PhotometricStereo(scene, settings, 0, threads).depth_map(view) for view in views],
            "sgbm": lambda: [semi_global(scene, view) for view in views],
        },
        repeat,
    )
    megapixels = n_views * scene.pinhole.width * scene.pinhole.height / 1e6
    rows = []
    for name, title in (("ours", "this project"), ("sgbm", "OpenCV SGBM")):
        seconds = times[name].median
        target = "at least 0.055" if name == "ours" else ""
        judged = [judge(scene, view, depth) for view, depth in zip(views, maps[name], strict=True)]
        near, far = np.mean(judged, axis=0)
        rows += [
            Row(f"{title}: a depth map", seconds / n_views, "s"),
            Row(f"{title}: speed", megapixels / seconds / threads, "Mpx/s a core", target),
            Row(f"{title}: pixels with a depth", float(np.mean([(depth > 0).mean() for depth in maps[name]]))),
            Row(f"{title}: sparse points within 1 %", float(near)),
            Row(f"{title}: sparse points farther off", float(far)),
        ]
    ratio = Row("ratio of times", times["sgbm"].median / times["ours"].median, "x")
    size = f"{scene.pinhole.width}x{scene.pinhole.height}"
    title = f"{n_views} views of {size}, {SOURCES} sources, {threads} threads, median of {repeat}"
    return Table("dense", title, (*rows, ratio))


def judge(scene: DenseScene, view: DenseView, depth: F32) -> tuple[float, float]:
    """Shares of the view's sparse points where the map is near, and where it is far; the rest has no depth."""
    pose, pinhole = scene.poses[view.name], scene.pinhole
    x_in_cam = pose.in_camera(scene.points[view.name])
    pixels = np.floor((x_in_cam @ pinhole.matrix().T)[:, :2] / x_in_cam[:, 2:]).astype(int)
    inside = ((pixels >= 0) & (pixels < (pinhole.width, pinhole.height))).all(axis=1) & (x_in_cam[:, 2] > 0)
    found = depth[pixels[inside, 1], pixels[inside, 0]]
    true = x_in_cam[inside, 2]
    near = (found > 0) & (np.abs(found - true) < NEAR * true)
    far = (found > 0) & ~near
    return float(near.mean()), float(far.mean())


def semi_global(scene: DenseScene, view: DenseView) -> F32:
    """Depth (h, w) of a view: median over its sources of rectified semi-global matching, 0 = none."""
    stack = np.stack([_pair(scene, view, source) for source in view.sources])
    stack[stack <= 0] = np.nan
    empty = np.isnan(stack).all(axis=0)
    stack[:, empty] = 0.0
    return np.asarray(np.nanmedian(stack, axis=0), np.float32)


def _pair(scene: DenseScene, view: DenseView, source: str) -> F32:
    """Depth of a view from one source, 0 where there is none."""
    pinhole = scene.pinhole
    K, size = pinhole.index_matrix(), (pinhole.width, pinhole.height)
    R, t = _relative(scene.poses[view.name], scene.poses[source])
    R1, R2, P1, P2, *_ = cv2.stereoRectify(K, NO_DISTORTION, K, NO_DISTORTION, size, R, t, flags=0, alpha=-1)
    vertical = abs(P2[1, 3]) > abs(P2[0, 3])
    left, right = (
        _u8(
            cv2.remap(
                scene.grey(name), *cv2.initUndistortRectifyMap(K, None, R_, P, size, cv2.CV_32FC1), cv2.INTER_LINEAR
            )
        )
        for name, R_, P in ((view.name, R1, P1), (source, R2, P2))
    )
    shift = P2[1, 3] if vertical else P2[0, 3]
    if vertical:
        left, right = _u8(cv2.transpose(left)), _u8(cv2.transpose(right))
    offset = (P1[1, 2] - P2[1, 2]) if vertical else (P1[0, 2] - P2[0, 2])
    disparity = _disparity(left, right, _range(shift, offset, view))
    if vertical:
        disparity = np.asarray(cv2.transpose(disparity), np.float32)
    with np.errstate(divide="ignore", invalid="ignore"):
        depth = np.where(np.isfinite(disparity), -shift / (disparity - offset), 0.0)
    return _to_view(depth.astype(np.float32), np.asarray(R1, np.float64), np.asarray(P1, np.float64), pinhole, view)


def _u8(picture: ArrayLike) -> NDArray[np.uint8]:
    return np.asarray(picture, np.uint8)


def _relative(reference: Pose, source: Pose) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    pose = source.relative_to(reference)
    return pose.R, pose.t[:, None]  # a column, as OpenCV wants it


def _range(shift: float, offset: float, view: DenseView) -> tuple[int, int]:
    """Smallest disparity and number of disparities (a multiple of 16) for the view's range of depths."""
    ends = [-shift / view.depth_min + offset, -shift / view.depth_max + offset]
    low = int(np.floor(min(ends)))
    return low, max(16, -(-int(np.ceil(max(ends)) - low + 1) // 16) * 16)


def _disparity(left: NDArray[np.uint8], right: NDArray[np.uint8], limits: tuple[int, int]) -> F32:
    """Disparity in px, NaN where the two directions or the uniqueness test disagree."""
    low, count = limits
    matcher = cv2.StereoSGBM.create(
        minDisparity=low,
        numDisparities=count,
        blockSize=5,
        P1=8 * 25,
        P2=32 * 25,
        disp12MaxDiff=1,
        uniquenessRatio=5,
        speckleWindowSize=50,
        speckleRange=2,
        mode=cv2.STEREO_SGBM_MODE_SGBM_3WAY,
    )
    # Without this margin the columns whose disparity leaves the image would be lost for all disparities.
    margin = max(0, low + count, -low)
    wide = [cv2.copyMakeBorder(image, 0, 0, margin, margin, cv2.BORDER_CONSTANT) for image in (left, right)]
    found = matcher.compute(*wide)[:, margin : margin + left.shape[1]]
    disparity = np.where(found <= (low - 1) * 16, np.nan, found / 16.0).astype(np.float32)
    # A match outside of the other picture, black after rectification, is none.
    columns = np.arange(left.shape[1]) - np.nan_to_num(disparity)
    inside = (columns >= 0) & (columns <= left.shape[1] - 1)
    other = np.take_along_axis(right, np.clip(columns, 0, left.shape[1] - 1).astype(int), axis=1)
    return np.where(inside & (left > 0) & (other > 0), disparity, np.nan).astype(np.float32)


def _to_view(depth: F32, R1: NDArray[np.float64], P1: NDArray[np.float64], pinhole: Pinhole, view: DenseView) -> F32:
    """Carry depth from the rectified image back to the view's pixels."""
    K = pinhole.index_matrix()
    v, u = np.mgrid[0 : pinhole.height, 0 : pinhole.width].astype(np.float64)
    rays = np.stack([(u - K[0, 2]) / K[0, 0], (v - K[1, 2]) / K[1, 1], np.ones_like(u)], axis=-1) @ R1.T
    x = (P1[0, 0] * rays[..., 0] / rays[..., 2] + P1[0, 2]).astype(np.float32)
    y = (P1[1, 1] * rays[..., 1] / rays[..., 2] + P1[1, 2]).astype(np.float32)
    carried = cv2.remap(depth, x, y, cv2.INTER_NEAREST, borderValue=0)
    # Depth along the rectified axis -> along the view's own: the ray has z = 1 in the view.
    own = carried / rays[..., 2]
    within = (own >= 0.8 * view.depth_min) & (own <= 1.25 * view.depth_max)
    return np.where(within, own, 0.0).astype(np.float32)
