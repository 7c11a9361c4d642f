"""Undistorted images and the matching PINHOLE model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
import pycolmap
from numpy.typing import NDArray

from core.dense.cameras import Pinhole
from core.geometry.boxes import in_box
from core.geometry.lens import lens_of

F32 = NDArray[np.float32]
U8 = NDArray[np.uint8]


@dataclass(frozen=True)
class UndistortMap:
    """Where every pinhole pixel lies in the distorted image (array indices), and which ones lie inside it."""

    x: F32
    y: F32
    inside: NDArray[np.bool_]

    def apply(self, image: U8) -> U8:
        """Undistort one (h, w, 3) image; black outside."""
        out = cv2.remap(image, self.x, self.y, cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE)
        out[~self.inside] = 0
        return np.asarray(out, dtype=np.uint8)


def undistort_map(camera: pycolmap.Camera, pinhole: Pinhole) -> UndistortMap:
    """The map from `pinhole` to the distorted image of `camera` (pycolmap.Camera)."""
    v, u = np.mgrid[0 : pinhole.height, 0 : pinhole.width]
    rays = np.empty((u.size, 3))
    rays[:, 0] = (u.ravel() + 0.5 - pinhole.cx) / pinhole.focal_px
    rays[:, 1] = (v.ravel() + 0.5 - pinhole.cy) / pinhole.focal_px
    rays[:, 2] = 1.0
    pixels = np.asarray(camera.img_from_cam(rays), dtype=np.float64)
    inside = np.isfinite(pixels).all(axis=1) & lens_of(camera).before_fold(rays)
    pixels[~inside] = -1.0
    inside &= in_box(pixels, (0.5, 0.5, camera.width - 0.5, camera.height - 0.5))
    shape = (pinhole.height, pinhole.width)
    # COLMAP's pixel centres are at 0.5, OpenCV's remap wants array indices.
    index = (pixels - 0.5).astype(np.float32)
    return UndistortMap(
        np.ascontiguousarray(index[:, 0].reshape(shape)),
        np.ascontiguousarray(index[:, 1].reshape(shape)),
        inside.reshape(shape),
    )


def pinhole_model(
    model: pycolmap.Reconstruction, pinhole: Pinhole, image_ids: Sequence[int]
) -> pycolmap.Reconstruction:
    """A reconstruction of the given images with the PINHOLE camera and the tracks that fall into it.

    Image ids, names and poses are those of `model`. Observations outside the pinhole's image are dropped,
    and points that fewer than two of the images observe.
    """
    out = pycolmap.Reconstruction()
    params = [pinhole.focal_px, pinhole.focal_px, pinhole.cx, pinhole.cy]
    out.add_camera_with_trivial_rig(
        pycolmap.Camera(model="PINHOLE", width=pinhole.width, height=pinhole.height, params=params, camera_id=1)
    )
    tracks: dict[int, list[tuple[int, int]]] = {}
    for image_id in sorted(image_ids):
        source = model.images[image_id]
        ids, pixels = _undistorted_observations(source, model.cameras[source.camera_id], pinhole)
        image = pycolmap.Image(name=source.name, camera_id=1, image_id=image_id)
        image.points2D = pycolmap.Point2DList([pycolmap.Point2D(pixel) for pixel in pixels])
        out.add_image_with_trivial_frame(image, source.cam_from_world())
        for index, point_id in enumerate(ids):
            tracks.setdefault(point_id, []).append((image_id, index))
    for point_id in sorted(tracks):
        if len(tracks[point_id]) < 2:
            continue
        point, track = model.points3D[point_id], pycolmap.Track()
        for image_id, index in tracks[point_id]:
            track.add_element(image_id, index)
        out.add_point3D(point.xyz, track, point.color)
    return out


def _undistorted_observations(
    image: pycolmap.Image, camera: pycolmap.Camera, pinhole: Pinhole
) -> tuple[list[int], NDArray[np.float64]]:
    """Ids of the observed points and their (n, 2) pixels in the pinhole, one observation a point."""
    seen: dict[int, NDArray[np.float64]] = {}
    for observation in image.get_observation_points2D():
        seen.setdefault(int(observation.point3D_id), observation.xy)
    if not seen:
        return [], np.zeros((0, 2))
    ids = np.array(list(seen))
    rays = np.asarray(camera.cam_from_img(np.array(list(seen.values()))), dtype=np.float64)
    pixels = rays * pinhole.focal_px + [pinhole.cx, pinhole.cy]
    inside = in_box(pixels, (0, 0, pinhole.width, pinhole.height), border=False)
    return [int(i) for i in ids[inside]], pixels[inside]
