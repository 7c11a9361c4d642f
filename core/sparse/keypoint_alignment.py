"""Keypoints of a track moved to the same spot of the metal: what one image shows there is looked for in the others.

A detector finds a corner again to within half a pixel to one and a half, differently in every image. With a model at
hand the images themselves say better: the patch around the keypoint of one image, warped by the surface's local plane
into another, correlates best where the same spot is, to a tenth of a pixel. (Idea: Lindenberger et al., Pixel-Perfect
Structure-from-Motion, ICCV 2021, on feature maps; here on grey values, which is Lucas and Kanade's alignment.)

Highlights align as well as scratches do; which tracks lie on the metal is for `core.sparse.trimming` to say.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

import cv2
import numpy as np
import pycolmap
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from core.products.adjustment import Alignment
from core.scene.frame import image_name
from core.scene.views import Views, views_of
from core.sparse.alignment_kernels import align_patches, take_patches

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
I64 = NDArray[np.int64]
Bool = NDArray[np.bool_]

RADIUS = 7
"""Of a patch in px. On a rendered clip 5, 7 and 9 leave tracks 0.21, 0.17 and 0.16 px off; larger is less plane."""
BLUR_PX = 0.8
"""Sigma by which images are smoothed first: noise goes, and bilinear sampling loses its bias."""
MIN_CORRELATION = 0.9
MAX_SHIFT_PX = 3.0
MAX_ITERATIONS = 12
NEIGHBOURS = 12
"""Points that say how the surface lies at a point,"""
FLATNESS = 0.15
"""where the least of their three variances is below this share of the middle one"""
MIN_COSINE = 0.35
"""and their plane does not face away; elsewhere it is taken to face the cameras."""
MIN_PER_IMAGE = 40
"""An image that aligns with fewer keypoints keeps the others as they are: it has to be held."""
PIXEL_CENTRE = 0.5
"""COLMAP's coordinates of the first pixel's centre."""

Read = Callable[[str], NDArray[np.uint8]]
"""Grey picture of an image by its name."""


@dataclass(frozen=True)
class _Tracks:
    """The points and their observations; every point has one reference image."""

    point_ids: I64
    """(n,)"""
    xyz: F64
    """(n, 3)"""
    normals: F64
    """(n, 3) of the surface, towards the cameras."""
    reference: I64
    """(n,) row of the image whose patch is looked for."""
    reference_xy: F64
    """(n, 2) px"""
    point: I64
    """(m,) row of the point of every other observation,"""
    image: I64
    """(m,) row of its image,"""
    keypoint: I64
    """(m,) index of its keypoint there."""
    xy: F64
    """(m, 2) px"""


def align_keypoints(
    model: pycolmap.Reconstruction, read: Read, still: Bool | None = None, *, drop: bool = True, threads: int = 1
) -> Alignment:
    """Move keypoints of a model in place.

    Args:
        model: of images that share one camera.
        read: pictures of its images.
        still: (height, width) pixels that do not move with the scene; patches that touch one are not used.
        drop: delete observations that do not align, unless their image would be left with too few.
        threads: of this process; the result does not depend on it.
    """
    views = _views(model)
    tracks = _tracks(model, views)
    if not len(tracks.point):
        return Alignment(observations=0, aligned=0, median_shift_px=0.0)
    warps = _warps(tracks, views, next(iter(model.cameras.values())))
    references = _by_image(tracks.reference, len(views))
    finite = np.asarray(np.isfinite(warps).all(axis=(1, 2)), np.bool_)
    others = _by_image(tracks.image, len(views), finite)
    weights = _weights()
    moving = None if still is None else ~cv2.dilate(still.astype(np.uint8), np.ones((2 * RADIUS + 3,) * 2)).astype(bool)
    patches = np.empty((len(tracks.xyz), 2 * RADIUS + 3, 2 * RADIUS + 3), np.float32)
    places, found = tracks.xy - PIXEL_CENTRE, np.full(len(tracks.xy), -1.0)

    def take(row: int) -> None:
        own = references[row]
        at = tracks.reference_xy[own] - PIXEL_CENTRE
        out = np.empty((len(own), *patches.shape[1:]), np.float32)
        take_patches(_smooth(read(image_name(int(views.frame_index[row])))), at, out)
        out[~_on(moving, at)] = np.nan
        patches[own] = out

    def align(row: int) -> None:
        own = others[row]
        start = places[own]
        at = start.copy()
        image = _smooth(read(image_name(int(views.frame_index[row]))))
        score = align_patches(image, patches[tracks.point[own]], warps[own], weights, MAX_ITERATIONS, MAX_SHIFT_PX, at)
        found[own] = np.where(_on(moving, start), score, -1.0)
        places[own] = at

    with ThreadPoolExecutor(threads) as pool:
        list(pool.map(take, range(len(views))))
        list(pool.map(align, range(len(views))))
    good = found >= MIN_CORRELATION
    _write(model, views, tracks, places + PIXEL_CENTRE, good, drop)
    shift = np.linalg.norm(places + PIXEL_CENTRE - tracks.xy, axis=1)[good]
    return Alignment(
        observations=len(good),
        aligned=int(good.sum()),
        median_shift_px=float(np.median(shift)) if good.any() else 0.0,
    )


def _by_image(image: I64, count: int, wanted: Bool | None = None) -> list[I64]:
    """Rows of each of `count` images, in order; only those that are wanted."""
    rows = np.arange(len(image)) if wanted is None else np.flatnonzero(wanted)
    rows = rows[np.argsort(image[rows], kind="stable")]
    return np.split(rows, np.searchsorted(image[rows], np.arange(1, count)))


def _smooth(picture: NDArray[np.uint8]) -> F32:
    return np.asarray(cv2.GaussianBlur(picture.astype(np.float32), (0, 0), BLUR_PX), np.float32)


def _on(mask: Bool | None, places: F64) -> Bool:
    """(m,) which places lie on pixels of the mask; all without one."""
    if mask is None:
        return np.ones(len(places), bool)
    column, row = np.rint(places).astype(np.int64).T
    on: Bool = mask[row.clip(0, mask.shape[0] - 1), column.clip(0, mask.shape[1] - 1)]
    return on


def _weights() -> F64:
    """Of the pixels of a patch: less towards its border, where another plane may begin."""
    offset = np.arange(-RADIUS, RADIUS + 1)
    bell = np.exp(-(offset**2) / (2 * (0.6 * RADIUS) ** 2))
    weights = np.outer(bell, bell).ravel()
    found: F64 = weights / weights.sum()
    return found


def _views(model: pycolmap.Reconstruction) -> Views:
    """The registered images. Their poses are made contiguous: sums over strided arrays may differ in the last bit."""
    views = views_of(model)
    return replace(views, R=np.ascontiguousarray(views.R), t=np.ascontiguousarray(views.t))


def _tracks(model: pycolmap.Reconstruction, views: Views) -> _Tracks:
    """References are the images that look most nearly along the mean of their point's viewing directions."""
    row_of = {image_id: row for row, image_id in enumerate(views.image_ids)}
    keypoints = [np.array([p.xy for p in model.image(i).points2D]).reshape(-1, 2) for i in views.image_ids]
    point_ids = np.array(sorted(int(i) for i in model.point3D_ids()), np.int64)
    centers, towards = views.centers, np.empty((len(point_ids), 3))
    reference, reference_xy = np.empty(len(point_ids), np.int64), np.empty((len(point_ids), 2))
    others = []
    for row, point_id in enumerate(point_ids.tolist()):
        point = model.point3D(point_id)
        track = [(row_of[element.image_id], int(element.point2D_idx)) for element in point.track.elements]
        directions = centers[[image for image, _ in track]] - point.xyz
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        mean = directions.mean(axis=0)
        towards[row] = mean / np.linalg.norm(mean)
        best = int(np.argmax(directions @ mean))
        reference[row], reference_xy[row] = track[best][0], keypoints[track[best][0]][track[best][1]]
        others += [(row, image, keypoint) for at, (image, keypoint) in enumerate(track) if at != best]
    of_point, of_image, of_keypoint = np.array(others, np.int64).reshape(-1, 3).T
    xy = np.array([keypoints[image][keypoint] for _, image, keypoint in others]).reshape(-1, 2)
    xyz = np.array([model.point3D(int(i)).xyz for i in point_ids]).reshape(-1, 3)
    return _Tracks(point_ids, xyz, _normals(xyz, towards), reference, reference_xy, of_point, of_image, of_keypoint, xy)


def _normals(xyz: F64, towards: F64) -> F64:
    """(n, 3) unit normals of the planes through each point's neighbours, and `towards` where these are none."""
    if len(xyz) < NEIGHBOURS:
        return towards
    near = xyz[cKDTree(xyz).query(xyz, NEIGHBOURS)[1]]
    near = near - near.mean(axis=1, keepdims=True)
    variance, axes = np.linalg.eigh(np.einsum("nki,nkj->nij", near, near))
    normal = axes[:, :, 0]
    cosine = (normal * towards).sum(axis=1)
    plane = (variance[:, 0] < FLATNESS * variance[:, 1]) & (np.abs(cosine) > MIN_COSINE)
    found: F64 = np.where(plane[:, None], normal * np.sign(cosine)[:, None], towards)
    return found


def _warps(tracks: _Tracks, views: Views, camera: pycolmap.Camera) -> F64:
    """(m, 2, 2) derivative of a place in the image by one in the reference, over the plane of the point."""
    step = 2.0
    columns = [
        (_carried(tracks, views, camera, offset) - _carried(tracks, views, camera, -offset)) / (2 * step)
        for offset in step * np.eye(2)
    ]
    return np.stack(columns, axis=-1)


def _carried(tracks: _Tracks, views: Views, camera: pycolmap.Camera, offset: F64) -> F64:
    """(m, 2) where the images see what lies on the point's plane at this offset (px) from the reference's keypoint."""
    flat = np.asarray(camera.cam_from_img(np.ascontiguousarray(tracks.reference_xy + offset))).reshape(-1, 2)
    ray = np.einsum("nji,nj->ni", views.R[tracks.reference], np.hstack([flat, np.ones((len(flat), 1))]))
    center = views.centers[tracks.reference]
    with np.errstate(divide="ignore", invalid="ignore"):
        depth = ((tracks.xyz - center) * tracks.normals).sum(axis=1) / (ray * tracks.normals).sum(axis=1)
    on_plane = (center + depth[:, None] * ray)[tracks.point]
    seen = np.einsum("nij,nj->ni", views.R[tracks.image], on_plane) + views.t[tracks.image]
    carried: F64 = np.full((len(seen), 2), np.nan)
    before = np.isfinite(seen).all(axis=1) & (seen[:, 2] > 0)
    if before.any():
        carried[before] = np.asarray(camera.img_from_cam(np.ascontiguousarray(seen[before]))).reshape(-1, 2)
    return carried


def _write(model: pycolmap.Reconstruction, views: Views, tracks: _Tracks, xy: F64, good: Bool, drop: bool) -> None:
    """Put the found places into the model; observations without one go where `drop` allows."""
    left = np.bincount(tracks.reference, minlength=len(views))
    left += np.bincount(tracks.image[good], minlength=len(views))
    doomed = ~good & drop & (left >= MIN_PER_IMAGE)[tracks.image]
    for image_id, moved in zip(views.image_ids, _by_image(tracks.image, len(views), good), strict=True):
        points = model.image(image_id).points2D
        for at in moved.tolist():
            points[int(tracks.keypoint[at])].xy = xy[at]
    for at in np.flatnonzero(doomed).tolist():
        point_id = int(tracks.point_ids[tracks.point[at]])
        # A track of two goes as a whole; it stays, as it is, for the adjustment to judge.
        if model.point3D(point_id).track.length() > 2:
            model.delete_observation(views.image_ids[int(tracks.image[at])], int(tracks.keypoint[at]))
