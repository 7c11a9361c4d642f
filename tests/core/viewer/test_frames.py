"""Frames in viewer.json: digits enough for the page, and few enough for a long video."""

from __future__ import annotations

from pathlib import Path

import cv2  # noqa: F401  (before pycolmap)
import numpy as np
import pytest

from core.flags import Verdict
from core.io.sparse import open_model
from core.report.build import Report
from core.scene.views import Views, views_of
from core.viewer.build import poses_of
from core.viewer.deliver import ascii_json
from core.viewer.document import ViewerSource, viewer_document
from core.viewer.scene import Pictures, SurfaceFacts, ViewerScene
from tests.old_release import unpack

FPS = 12.0
SURFACE = SurfaceFacts(faces=1, published_faces=1, spacing=1.0)


@pytest.fixture(scope="module")
def views(tmp_path_factory: pytest.TempPathFactory) -> Views:
    """Those of the reconstruction that the first release made of a rendered clip."""
    return views_of(open_model(unpack("result", tmp_path_factory.mktemp("frames")) / "sparse"))


def test_rounded_poses_move_no_point_by_a_thousandth_of_a_pixel(tmp_path: Path, views: Views) -> None:
    model = open_model(unpack("result", tmp_path) / "sparse")
    points = np.array([point.xyz for point in model.points3D.values()])
    assert len(points) > 400
    poses = poses_of(views)
    assert list(poses) == views.frame_index.tolist()
    moved = []
    for row, rounded in enumerate(poses.values()):
        kept = np.array(rounded).reshape(3, 4)
        exact = views.camera.img_from_cam(points @ views.R[row].T + views.t[row])
        shown = views.camera.img_from_cam(points @ kept[:, :3].T + kept[:, 3])
        near = np.isfinite(exact).all(axis=1)
        near[near] = (np.abs(exact[near]) < 4 * views.camera.width).all(axis=1)
        assert near.mean() > 0.5
        moved.append(np.abs(exact - shown)[near].max())
    assert 0.0 < max(moved) < 0.001
    assert np.abs(np.array([*poses.values()]).reshape(-1, 3, 4)[..., :3] - views.R).max() < 1e-7


@pytest.mark.parametrize("first", [0, 2000])
def test_a_registered_frame_takes_at_most_three_tenths_of_a_kilobyte(views: Views, first: int) -> None:
    poses = {first + index: pose for index, pose in poses_of(views).items()}
    rows = [{"index": i, "video": 0, "source_index": i, "time_s": i / FPS, "model": 0} for i in poses]
    pictures = Pictures(960, 720, dict.fromkeys(poses, 0.5), {i: i for i in poses}, None, (), {})
    scene = ViewerScene({}, poses, None, SURFACE, (), (), ())
    report = Report(Verdict.OK, {}, {}, rows, (), [], [], [])
    frames = viewer_document(ViewerSource(report, scene, pictures))["frames"]
    assert len(frames) == len(views)
    assert all(frame["registered"] and "reason" not in frame for frame in frames)
    assert frames[1]["time_s"] == pytest.approx(rows[1]["time_s"], abs=1e-4)
    sizes = [len(ascii_json(frame)) + 1 for frame in frames]
    assert np.mean(sizes) <= 300
