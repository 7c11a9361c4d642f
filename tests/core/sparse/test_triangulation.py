from __future__ import annotations

import numpy as np
import pycolmap
from scipy.optimize import least_squares

from core.sparse.densify import transfer_poses
from core.sparse.tracks import Tracks
from core.sparse.triangulation import _nearest, add_track_points
from core.sparse.view_graph import Frames
from core.verification import camera_from_dict
from tests.core.sparse.scene import LENS, project

CENTERS = np.array([[0.0, 0, 0], [0.4, 0, 0], [0.8, 0.1, 0], [1.2, 0, 0.1]])
POINTS = np.array([[0.2, 0.1, 3.0], [1.0, -0.3, 4.0], [0.5, 0.5, 500.0]])


def setting(keypoints: list[np.ndarray]) -> tuple[pycolmap.Reconstruction, Frames]:
    """A model with the poses `CENTERS`, unturned, and its frames."""
    camera = camera_from_dict(LENS)
    model = pycolmap.Reconstruction()
    model.add_camera_with_trivial_rig(camera)
    for i, (xy, center) in enumerate(zip(keypoints, CENTERS, strict=True)):
        image = pycolmap.Image(name=f"{i:04d}.jpg", keypoints=xy, camera_id=1, image_id=i + 1)
        model.add_image_with_trivial_frame(image, pycolmap.Rigid3d(pycolmap.Rotation3d(), -center))
    indices = tuple(range(len(keypoints)))
    return model, Frames(indices, tuple(f"{i:04d}.jpg" for i in indices), tuple(keypoints), camera)


def tracks_of(rows: list[list[tuple[int, int]]]) -> Tracks:
    flat = np.array([item for row in rows for item in row], dtype=np.int64).reshape(-1, 2)
    return Tracks(np.cumsum([0, *(len(row) for row in rows)]).astype(np.int64), flat[:, 0].copy(), flat[:, 1].copy())


def seen() -> list[np.ndarray]:
    return [project(POINTS - center) for center in CENTERS]


def whole(point: int) -> list[tuple[int, int]]:
    return [(frame, point) for frame in range(len(CENTERS))]


def test_exact_rays_meet_in_the_point() -> None:
    model, frames = setting(seen())
    assert add_track_points(model, tracks_of([whole(0), whole(1)]), frames) == 2
    found = np.array([model.points3D[i].xyz for i in sorted(model.point3D_ids())])
    np.testing.assert_allclose(found, POINTS[:2], atol=1e-9)
    assert all(point.track.length() == 4 for point in model.points3D.values())


def test_an_observation_that_does_not_fit_is_left_out() -> None:
    keypoints = seen()
    keypoints[2][0] += [30.0, -12.0]
    model, frames = setting(keypoints)
    assert add_track_points(model, tracks_of([whole(0)]), frames) == 1
    point = next(iter(model.points3D.values()))
    assert sorted(element.image_id for element in point.track.elements) == [1, 2, 4]
    np.testing.assert_allclose(point.xyz, POINTS[0], atol=1e-9)


def test_far_points_and_short_tracks_give_none() -> None:
    model, frames = setting(seen())
    assert add_track_points(model, tracks_of([whole(2), [(0, 0), (3, 0)]]), frames) == 0
    assert model.num_points3D() == 0


def test_a_track_of_three_that_do_not_meet_gives_no_point() -> None:
    keypoints = seen()
    keypoints[2][0] += [30.0, -12.0]
    model, frames = setting(keypoints)
    assert add_track_points(model, tracks_of([whole(0)[:3]]), frames) == 0
    assert model.num_points3D() == 0


def test_a_point_lies_where_the_angles_to_its_rays_are_least() -> None:
    """Cameras ten times as far away count as much: distances to their rays are ten times as large."""
    centers = np.array([[0.5, 0.0, -1.0], [-0.5, 0.2, -1.0], [4.0, 0.0, -10.0], [-4.0, 3.0, -10.0]])
    rng = np.random.default_rng(0)
    rays = -centers / np.linalg.norm(centers, axis=1, keepdims=True) + rng.normal(0, 0.003, (4, 3))
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)

    def sines(place: np.ndarray) -> np.ndarray:
        lines = place - centers
        return np.cross(rays, lines / np.linalg.norm(lines, axis=1, keepdims=True)).ravel()

    best = least_squares(sines, np.zeros(3), xtol=1e-14, ftol=1e-14).x
    (found,) = _nearest(np.array([0]), rays, centers)
    assert np.linalg.norm(best) > 1e-3, "the rays do not meet at the origin"
    assert np.linalg.norm(found - best) < 0.02 * np.linalg.norm(best)


def test_images_without_pose_take_no_part() -> None:
    model, frames = setting(seen())
    model.deregister_frame(model.image(4).frame_id)
    assert add_track_points(model, tracks_of([whole(0)]), frames) == 1
    assert next(iter(model.points3D.values())).track.length() == 3


def test_poses_and_lens_carry_over_without_points() -> None:
    model, frames = setting(seen())
    add_track_points(model, tracks_of([whole(0)]), frames)
    model.camera(1).params = list(np.array([333.0, 334.0, *model.camera(1).params[2:]]))
    cache = pycolmap.DatabaseCache()
    cache.add_camera(frames.camera)
    rig = pycolmap.Rig(rig_id=1)
    rig.add_ref_sensor(frames.camera.sensor_id)
    cache.add_rig(rig)
    for image_id in (2, 3):
        image = pycolmap.Image(name=f"{image_id - 1:04d}.jpg", keypoints=seen()[0], camera_id=1, image_id=image_id)
        frame = pycolmap.Frame()
        frame.frame_id, frame.rig_id = image_id, 1
        frame.add_data_id(image.data_id)
        cache.add_frame(frame)
        image.frame_id = image_id
        cache.add_image(image)
    copy = transfer_poses(cache, model)
    assert sorted(copy.reg_image_ids()) == [2, 3]
    assert copy.num_points3D() == 0
    assert list(copy.camera(1).params[:2]) == [333.0, 334.0]
    np.testing.assert_allclose(copy.image(3).projection_center(), CENTERS[2], atol=1e-12)


def test_no_track_has_no_point() -> None:
    nothing = _nearest(np.zeros(0, np.int64), np.zeros((0, 3)), np.zeros((0, 3)))
    assert nothing.shape == (0, 3)
