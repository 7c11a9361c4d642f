"""The comparisons compare what they say."""

from __future__ import annotations

import json
from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from bench.main import main
from bench.speed import dense, disk, mapping, stages
from bench.speed.finished import FinishedRun
from bench.speed.matching import draw_pairs
from bench.speed.timing import Row, Table, Timing, interleaved
from bench.speed.windows import choose_windows
from core.dense.cameras import Pinhole
from core.dense.maps import DenseScene
from core.dense.views import DenseView
from core.geometry.pose import Pose
from core.io.frames import write_frames
from core.scene.frame import Crop
from core.settings import make_settings
from core.surface.ply import Mesh
from tests.core.making_rows import run_frames


def make_run(out: Path, **folders: Path) -> FinishedRun:
    return FinishedRun(out, make_settings(), dict(folders), {})


def test_sides_take_turns() -> None:
    order: list[str] = []
    timings = interleaved({"a": lambda: order.append("a"), "b": lambda: order.append("b")}, 3)
    assert order == ["a", "b"] * 3
    assert [len(timing.seconds) for timing in timings.values()] == [3, 3]
    assert Timing((3.0, 1.0, 2.0)).median == 2.0


def test_table_text() -> None:
    table = Table("x", "title", (Row("ratio", 2.5, "x", "at least 2"), Row("images", 12), Row("lost", None)))
    assert table.text().splitlines() == [
        "x: title",
        "  ratio   2.5 x   (at least 2)",
        "  images  12",
        "  lost    -",
    ]


def test_disk_is_compared_with_the_same_result(tmp_path: Path) -> None:
    images = tmp_path / "frames" / "images"
    images.mkdir(parents=True)
    picture = np.random.default_rng(0).integers(0, 255, (16, 20, 3), np.uint8)
    cv2.imwrite(str(images / "0000.png"), cv2.resize(picture, (160, 128), interpolation=cv2.INTER_CUBIC))
    (images / "0000.png").rename(images / "0000.jpg")
    table = disk.compare(make_run(tmp_path, frames=tmp_path / "frames"), threads=1, repeat=1, n_frames=1)
    rows = {row.name: row.value for row in table.rows}
    assert rows["keypoints that both find"] == 1.0
    assert float(str(rows["largest descriptor difference"])) < 1e-5


def test_pairs_are_drawn_once_and_for_all(tmp_path: Path) -> None:
    (tmp_path / "frames").mkdir()
    write_frames(tmp_path / "frames", run_frames(40, 1 / 12), Crop(0, 0, 160, 128, 160, 128))
    run = make_run(tmp_path, frames=tmp_path / "frames")
    pairs = draw_pairs(run, 30)
    assert pairs == draw_pairs(run, 30)
    assert len(set(pairs)) == 30
    assert {b - a for a, b in pairs} == {1, 2, 3, 4, 5}


def test_windows_are_whole_and_of_both_kinds(tmp_path: Path) -> None:
    windows = choose_windows(360, make_run(tmp_path))
    assert [w.start for w in windows] == [0, 80, 160]
    assert {w.end - w.start for w in windows} == {180}
    assert [bool(w.warm_from) for w in windows] == [False, True, True]


def test_refined_mesh_is_the_same_surface() -> None:
    vertices = np.array([[0, 0, 0], [2, 0, 0], [0, 2, 0], [2, 2, 1.0]])
    mesh = mapping.refine(Mesh(vertices, np.array([[0, 1, 2], [1, 3, 2]], np.int32)), 80)
    assert 80 <= len(mesh.vertices) <= 82
    a, b, c = (mesh.vertices[mesh.faces[:, i]] for i in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
    assert area == pytest.approx(2 + np.linalg.norm(np.cross([0, 2, 1], [-2, 2, 0])) / 2)


def plane_scene(folder: Path) -> DenseScene:
    """A textured plane z = 5 + 0.2 x seen from the origin, from the right, and from below."""
    pinhole = Pinhole(300.0, 160.0, 120.0, 320, 240)
    rng = np.random.default_rng(1)
    texture = cv2.resize(rng.integers(0, 255, (200, 200), np.uint8), (1600, 1600), interpolation=cv2.INTER_CUBIC)
    (folder / "images").mkdir()
    turn = np.asarray(cv2.Rodrigues(np.array([0.02, -0.03, 0.05]))[0], np.float64)
    poses = {
        "a": Pose(np.eye(3), np.zeros(3)),
        "b": Pose(turn, turn @ np.array([-0.4, 0.0, 0.0])),
        "c": Pose(np.eye(3), np.array([0.0, -0.4, 0.0])),
    }
    # Texture pixel (s, t) is the point (x, y, 5 + 0.2 x), 100 pixels a unit, centre at (800, 800).
    plane = np.array([[0.01, 0, -8.0], [0, 0.01, -8.0], [0.002, 0, 5 - 1.6]])
    for name, pose in poses.items():
        H = pinhole.index_matrix() @ (pose.R @ plane + np.outer(pose.t, [0, 0, 1]))
        image = cv2.warpPerspective(texture, H, (pinhole.width, pinhole.height))
        cv2.imwrite(str(folder / "images" / f"{name}.png"), image)
        (folder / "images" / f"{name}.png").rename(folder / "images" / name)
    grid = np.stack(np.meshgrid(np.linspace(-2, 2, 15), np.linspace(-1.5, 1.5, 15)), axis=-1).reshape(-1, 2)
    points = np.column_stack([grid, 5 + 0.2 * grid[:, 0]])
    views = (DenseView("a", 0, ("b", "c"), 4.0, 6.5),)
    return DenseScene(folder, pinhole, poses, dict.fromkeys(poses, points), views)


@pytest.mark.parametrize("sources", [("b",), ("c",), ("b", "c")])
def test_semi_global_matching_finds_a_plane(tmp_path: Path, sources: tuple[str, ...]) -> None:
    scene = plane_scene(tmp_path)
    view = DenseView("a", 0, sources, 4.0, 6.5)
    depth = dense.semi_global(scene, view)
    error = np.abs(depth / true_depth() - 1)[depth > 0]
    assert (depth > 0).mean() > 0.8
    assert np.percentile(error, 95) < 0.02
    assert np.median(error) < 0.01
    assert dense.judge(scene, view, depth)[0] > 0.75


def true_depth() -> NDArray[np.float32]:
    _, u = np.mgrid[0:240, 0:320] + 0.5
    return np.asarray(5 / (1 - 0.2 * (u - 160) / 300), np.float32)


def test_judging_depth(tmp_path: Path) -> None:
    scene = plane_scene(tmp_path)
    true = true_depth()
    assert dense.judge(scene, scene.views[0], true) == (1.0, 0.0)
    assert dense.judge(scene, scene.views[0], true * np.float32(1.02)) == (0.0, 1.0)
    half = true.copy()
    half[120:] = 0
    near, far = dense.judge(scene, scene.views[0], half)
    assert 0.4 < near < 0.6
    assert far == 0.0


def test_stage_table(tmp_path: Path) -> None:
    rows = [{"name": "a", "tasks": 2, "seconds": 3.5, "peak_rss_bytes": 2**30}]
    rows.append({"name": "b", "tasks": 1, "seconds": 1.0, "peak_rss_bytes": 2**31})
    (tmp_path / "summary.json").write_text(json.dumps({"preset": "draft", "stages": rows}))
    table = stages.compare(make_run(tmp_path), threads=1, repeat=1)
    assert [row.value for row in table.rows] == [3.5, 1.0, 4.5, 2.0]


def test_speed_refuses_what_is_no_run(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["speed", str(tmp_path)]) == 2
    assert "not the result folder of a run" in capsys.readouterr().err
    assert main(["speed", str(tmp_path), "--only", "disc"]) == 2
    assert "unknown comparison 'disc'" in capsys.readouterr().err
