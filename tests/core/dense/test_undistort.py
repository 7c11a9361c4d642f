"""The pinhole rule, the undistorted picture, and the PINHOLE model."""

from __future__ import annotations

import cv2
import numpy as np
import pycolmap
import pytest

from core.dense.cameras import choose_pinhole
from core.dense.maps import open_scene
from core.dense.undistort import undistort_map
from core.dense.views import read_views
from core.settings import make_settings
from tests.core.dense import making_scenes as scenes
from tests.core.dense.conftest import Undistorted


def _fisheye(focal: float = 520.0) -> pycolmap.Camera:
    params = [focal, focal, 442.0, 281.0, 0.0, 0.0, 0.0, 0.0]
    return pycolmap.Camera(model="OPENCV_FISHEYE", width=787, height=525, params=params, camera_id=1)


def test_centre_keeps_its_resolution_and_stretch_is_bounded() -> None:
    pinhole = choose_pinhole(_fisheye(), make_settings().dense)
    assert pinhole.focal_px == 520.0
    # 2 x stretch is 45 degrees: the left border (48.7 degrees off the axis) is pulled in to tan = 1.
    assert pinhole.cx == pytest.approx(520.0, abs=0.5)
    # On the right, x is largest where the border leaves the 45 degree circle: 345 of 520 * pi / 4 px from the centre.
    assert pinhole.width - pinhole.cx == pytest.approx(345 / (np.pi / 4), abs=3)


def test_scale_and_size_limit_shrink_the_whole_image() -> None:
    whole = choose_pinhole(_fisheye(), make_settings().dense)
    half = choose_pinhole(_fisheye(), make_settings("default", {"dense.scale": 0.5}).dense)
    small = choose_pinhole(_fisheye(), make_settings("default", {"dense.max_image_size_px": 400}).dense)
    assert half.focal_px == 260.0
    assert abs(half.width - whole.width / 2) <= 1
    assert 398 <= max(small.width, small.height) <= 400
    assert small.cx / small.width == pytest.approx(whole.cx / whole.width, abs=2e-3)


def test_halving_keeps_rays() -> None:
    pinhole = choose_pinhole(_fisheye(), make_settings().dense)
    half = pinhole.halved()
    ray = np.array([0.2, -0.1, 1.0])
    fine, coarse = pinhole.index_matrix() @ ray, half.index_matrix() @ ray
    # Index i of the coarse image covers 2i and 2i + 1 of the fine one.
    np.testing.assert_allclose(coarse[:2] * 2 + 0.5, fine[:2], atol=1e-9)


def test_undistorted_image_is_what_a_pinhole_camera_would_see(undistorted: Undistorted) -> None:
    scene = open_scene(undistorted.folder)
    pin = scene.pinhole
    params = [pin.focal_px, pin.focal_px, pin.cx, pin.cy]
    cam = pycolmap.Camera(model="PINHOLE", width=pin.width, height=pin.height, params=params, camera_id=1)
    v, u = np.mgrid[0 : pin.height, 0 : pin.width]
    rays = np.column_stack([np.asarray(cam.cam_from_img(np.column_stack([u.ravel() + 0.5, v.ravel() + 0.5])))])
    rays = np.column_stack([rays, np.ones(len(rays))])
    pose = scenes.poses(6)[2]
    center = -pose[:, :3].T @ pose[:, 3]
    t, _ = undistorted.scene.hit(center, rays @ pose[:, :3])
    truth = undistorted.scene.texture(center + (rays @ pose[:, :3]) * t[:, None]).reshape(pin.height, pin.width)
    seen = cv2.imread(str(undistorted.folder / "images" / "0002.jpg"), cv2.IMREAD_GRAYSCALE)
    assert seen is not None
    seen = seen.astype(float)
    inside = cv2.erode(scene.mask().astype(np.uint8), np.ones((5, 5))) > 0
    error = np.abs(seen - truth)[inside]
    assert inside.mean() > 0.8
    assert np.median(error) < 3
    # A shift by half a pixel would show: it costs more than the JPEG does.
    moved = np.abs(np.roll(seen, 1, axis=1) - truth)[inside]
    assert np.median(moved) > 2 * np.median(error)


def test_mask_is_where_the_lens_sees() -> None:
    camera = _fisheye()
    mapping = undistort_map(camera, choose_pinhole(camera, make_settings().dense))
    picture = mapping.apply(np.full((525, 787, 3), 200, np.uint8))
    assert (picture[mapping.inside] == 200).all()
    assert (picture[~mapping.inside] == 0).all()
    assert mapping.inside.mean() > 0.8


def test_model_keeps_poses_and_its_tracks_project_onto_their_points(undistorted: Undistorted) -> None:
    model = pycolmap.Reconstruction(str(undistorted.folder / "sparse"))
    assert {camera.model.name for camera in model.cameras.values()} == {"PINHOLE"}
    assert undistorted.facts["n_views"] == 6
    errors = []
    for point in model.points3D.values():
        for element in point.track.elements:
            image = model.images[element.image_id]
            errors.append(np.linalg.norm(image.project_point(point.xyz) - image.points2D[element.point2D_idx].xy))
    assert len(errors) > 500
    assert max(errors) < 0.01
    names = {image.name for image in model.images.values()}
    for view in read_views(undistorted.folder):
        assert {view.name, *view.sources} <= names
