"""A textured wall under a fisheye that moves along it: pictures, a model with true cameras, keypoints that are off."""

from __future__ import annotations

import cv2
import numpy as np
import pycolmap
import pytest
from numpy.typing import NDArray

from core.sparse.keypoint_alignment import MAX_SHIFT_PX, MIN_PER_IMAGE, RADIUS, align_keypoints

Truth = dict[tuple[int, int], tuple[int, NDArray[np.float64]]]

WIDTH, HEIGHT, FOCAL, DEPTH = 320, 240, 170.0, 2.0
N_FRAMES, STEP, NOISE_PX = 7, 0.12, 0.7
TILT = np.radians(25.0)
U, V = np.array([np.cos(TILT), 0.0, np.sin(TILT)]), np.array([0.0, 1.0, 0.0])
NORMAL = np.cross(U, V)
ORIGIN = np.array([0.3, 0.0, DEPTH])
TEXELS_PER_UNIT = 110.0


def lens() -> pycolmap.Camera:
    params = [FOCAL, FOCAL, WIDTH / 2, HEIGHT / 2, -0.02, 0.0, 0.0, 0.0]
    return pycolmap.Camera(camera_id=1, model="OPENCV_FISHEYE", width=WIDTH, height=HEIGHT, params=params)


def pose(frame: int) -> pycolmap.Rigid3d:
    turn = pycolmap.Rotation3d(np.array([0.02 * frame, 0.05 * np.sin(frame), 0.03 * frame]))
    center = np.array([STEP * frame, 0.05 * np.cos(frame), 0.02 * frame])
    return pycolmap.Rigid3d(turn, -(turn.matrix() @ center))


def picture(frame: int, texture: np.ndarray, gain: float) -> np.ndarray:
    """Every pixel's ray met with the wall, and the light of this frame."""
    column, row = np.meshgrid(np.arange(WIDTH) + 0.5, np.arange(HEIGHT) + 0.5)
    flat = lens().cam_from_img(np.stack([column.ravel(), row.ravel()], axis=1))
    at = pose(frame)
    ray = np.hstack([flat, np.ones((len(flat), 1))]) @ at.rotation.matrix()
    center = -at.rotation.matrix().T @ at.translation
    on_wall = center + (((ORIGIN - center) @ NORMAL) / (ray @ NORMAL))[:, None] * ray - ORIGIN
    size = np.array(texture.shape[::-1])
    place = (on_wall @ np.stack([U, V], axis=1) * TEXELS_PER_UNIT + size / 2).reshape(HEIGHT, WIDTH, 2)
    x, y = np.moveaxis(place.astype(np.float32), -1, 0)
    seen = np.asarray(cv2.remap(texture, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REFLECT))
    return np.asarray(np.clip(gain * seen + 10.0 * frame - 20.0, 0, 255), np.uint8)


@pytest.fixture(scope="module")
def pictures() -> dict[str, np.ndarray]:
    rng = np.random.default_rng(3)
    texture = cv2.GaussianBlur(rng.normal(0, 1, (900, 1100)).astype(np.float32), (0, 0), 3.0)
    texture = 120.0 + 40.0 * texture / texture.std()
    return {f"{i:04d}.jpg": picture(i, texture, 0.7 + 0.1 * (i % 3)) for i in range(N_FRAMES)}


def project(xyz: np.ndarray, frame: int) -> np.ndarray:
    return np.asarray(lens().img_from_cam(xyz @ pose(frame).rotation.matrix().T + pose(frame).translation))


def make_model(n_points: int = 260) -> tuple[pycolmap.Reconstruction, Truth]:
    """The model, and where every keypoint should be, by (image id, index)."""
    rng = np.random.default_rng(4)
    places = rng.uniform([-0.9, -0.8], [1.1, 0.8], (n_points, 2))
    xyz = ORIGIN + places[:, :1] * U + places[:, 1:] * V
    model = pycolmap.Reconstruction()
    model.add_camera_with_trivial_rig(lens())
    tracks: dict[int, list[tuple[int, int]]] = {row: [] for row in range(n_points)}
    true = {}
    for frame in range(N_FRAMES):
        xy = project(xyz, frame)
        margin = RADIUS + MAX_SHIFT_PX + 3
        inside = np.flatnonzero(((xy > margin) & (xy < np.array([WIDTH, HEIGHT]) - margin)).all(axis=1))
        off = xy[inside] + rng.normal(0, NOISE_PX, (len(inside), 2)).clip(-1.8, 1.8)
        image = pycolmap.Image(name=f"{frame:04d}.jpg", keypoints=off, camera_id=1, image_id=frame + 1)
        model.add_image_with_trivial_frame(image, pose(frame))
        for index, row in enumerate(inside.tolist()):
            tracks[row].append((frame + 1, index))
            true[frame + 1, index] = (row, xy[row])
    for row, track in tracks.items():
        if len(track) >= 3:
            model.add_point3D(xyz[row], pycolmap.Track([pycolmap.TrackElement(*one) for one in track]), np.zeros(3))
    return model, true


def spread_px(model: pycolmap.Reconstruction, true: Truth) -> float:
    """Typical distance of keypoints from where the track's own spot is: what all of a track share is not counted."""
    found = []
    for point in model.points3D.values():
        offsets = np.array(
            [
                model.image(e.image_id).point2D(e.point2D_idx).xy - true[e.image_id, e.point2D_idx][1]
                for e in point.track.elements
            ]
        )
        found += np.linalg.norm(offsets - offsets.mean(axis=0), axis=1).tolist()
    return float(np.median(found))


def test_keypoints_of_a_track_come_to_the_same_spot(pictures: dict[str, NDArray[np.uint8]]) -> None:
    model, true = make_model()
    before, observations = spread_px(model, true), model.compute_num_observations()
    done = align_keypoints(model, pictures.__getitem__)
    assert done.aligned > 0.9 * done.observations > 500
    assert 0.3 < done.median_shift_px < 1.5
    assert before > 0.6
    assert spread_px(model, true) < 0.1 * before
    assert model.compute_num_observations() >= 0.9 * observations


def test_what_shows_another_spot_is_dropped_or_kept_as_it_is(pictures: dict[str, NDArray[np.uint8]]) -> None:
    wrong = (3, 40)
    for drop in (True, False):
        model, true = make_model()
        point_id = model.image(wrong[0]).point2D(wrong[1]).point3D_id
        moved = true[wrong][1] + [9.0, -8.0]
        model.image(wrong[0]).points2D[wrong[1]].xy = moved
        align_keypoints(model, pictures.__getitem__, drop=drop)
        held = (wrong[0], wrong[1]) in {(e.image_id, e.point2D_idx) for e in model.point3D(point_id).track.elements}
        assert held is not drop
        assert model.image(wrong[0]).point2D(wrong[1]).xy.tolist() == moved.tolist()


def test_a_picture_that_shows_nothing_keeps_its_keypoints(pictures: dict[str, NDArray[np.uint8]]) -> None:
    model, _ = make_model()
    blank = {**pictures, "0002.jpg": np.full((HEIGHT, WIDTH), 90, np.uint8)}
    before = model.image(3).num_points3D
    align_keypoints(model, blank.__getitem__)
    assert before > MIN_PER_IMAGE
    assert model.image(3).num_points3D > 0.8 * before


def test_keypoints_on_what_stands_still_are_left_alone(pictures: dict[str, NDArray[np.uint8]]) -> None:
    model, _ = make_model()
    still = np.zeros((HEIGHT, WIDTH), bool)
    still[90:150, 130:190] = True
    start = {i: np.array([p.xy for p in model.image(i).points2D]) for i in model.reg_image_ids()}
    align_keypoints(model, pictures.__getitem__, still, drop=False)
    moved = 0
    for image_id, before in start.items():
        after = np.array([p.xy for p in model.image(image_id).points2D])
        near = (np.abs(before - [160, 120]) < 30 + RADIUS).all(axis=1)
        assert near.any()
        assert np.array_equal(before[near], after[near])
        moved += int((before[~near] != after[~near]).any(axis=1).sum())
    assert moved > 300


def test_the_result_does_not_depend_on_the_threads(pictures: dict[str, NDArray[np.uint8]]) -> None:
    found = []
    for threads in (1, 2):
        model, _ = make_model()
        align_keypoints(model, pictures.__getitem__, threads=threads)
        found.append(np.concatenate([[p.xy for p in model.image(i).points2D] for i in sorted(model.reg_image_ids())]))
    assert np.array_equal(found[0], found[1])


def test_a_model_without_points_is_left_as_it_is(pictures: dict[str, NDArray[np.uint8]]) -> None:
    model, _ = make_model()
    for point_id in list(model.point3D_ids()):
        model.delete_point3D(point_id)
    assert align_keypoints(model, pictures.__getitem__).observations == 0
