"""Clips out of checkouts of others: poses in every form that a source writes, and scores against them."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pycolmap
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from bench.main import main
from bench.real import measure, peer
from bench.real.clip import Clip, Reference, read_reference, write_reference
from bench.real.command import cells
from bench.real.measure import Bench, Ended, run_and_time
from bench.real.score import Score, score_peer, score_product
from bench.real.sources import (
    FOUNTAIN,
    KITTI,
    KITTI_FRAMES,
    KITTI_POSES,
    SINUS,
    SOURCES,
    TEMPLE,
    TUBE,
    Source,
)
from core.errors import BadInput, StageFailed

F64 = NDArray[np.float64]

RNG = np.random.default_rng(3)
N = 6
CENTERS = RNG.normal(size=(N, 3))
ROTATIONS = Rotation.from_rotvec(RNG.normal(size=(N, 3))).as_matrix()
"""world_from_cam"""
FX, FY = 500.0, 504.0
WIDTH, HEIGHT = 64, 48
BY_NAME = {source.name: source for source in SOURCES}


def pictures(folder: Path, names: list[str]) -> None:
    folder.mkdir(parents=True)
    for name in names:
        cv2.imwrite(str(folder / name), np.full((HEIGHT, WIDTH, 3), 90, np.uint8))


def words(values: F64) -> str:
    return " ".join(f"{value:.12g}" for value in np.ravel(values))


def sinus(root: Path) -> None:
    folder = root / "EndoscopyDepthEstimation-Pytorch" / SINUS
    pictures(folder, [f"{4584 + i:08d}.jpg" for i in range(N)])
    (folder / "undistorted_mask.jpg").write_bytes(b"")
    lines = ["header: ", "  seq: 0", "  stamp: 0.0", "poses[]:"]
    for i in range(N):
        quaternion = Rotation.from_matrix(ROTATIONS[i]).as_quat()
        lines += [f"  poses[{i}]: ", "    position: "]
        lines += [f"      {axis}: {value:.12g}" for axis, value in zip("xyz", CENTERS[i], strict=True)]
        lines += ["    orientation: "]
        lines += [f"      {axis}: {value:.12g}" for axis, value in zip("xyzw", quaternion, strict=True)]
    (folder / "motion.yaml").write_text("\n".join(lines))
    (folder / "camera_intrinsics_per_view").write_text(f"{FX}\n{FY}\n32\n24\n")


def temple(root: Path) -> None:
    folder = root / "Multiple-View-Stereo" / TEMPLE
    names = [f"templeR{i + 1:04d}.png" for i in range(N)]
    pictures(folder, names)
    K = np.array([[FX, 0, 32], [0, FY, 24], [0, 0, 1]])
    rows = [str(N)]
    for name, R, center in zip(names, np.swapaxes(ROTATIONS, 1, 2), CENTERS, strict=True):
        rows.append(f"{name} {words(K)} {words(R)} {words(-R @ center)}")
    (folder / "templeR_par.txt").write_text("\n".join(rows) + "\n")


def fountain(root: Path) -> None:
    folder = root / "SfM_quality_evaluation" / FOUNTAIN
    pictures(folder / "images", [f"{i:04d}.jpg" for i in range(N)])
    (folder / "gt_dense_cameras").mkdir()
    for i in range(N):
        text = f"{FX} 0 32 \n0 {FY} 24 \n0 0 1 \n0 0 0\n{words(ROTATIONS[i])}\n{words(CENTERS[i])}\n{WIDTH} {HEIGHT}\n"
        (folder / "gt_dense_cameras" / f"{i:04d}.jpg.camera").write_text(text)


def kitti(root: Path) -> None:
    """More frames than the clip has, and more poses than frames."""
    folder = root / "3dv_tutorial" / KITTI
    pictures(folder / "image_0", [f"{i:06d}.png" for i in range(KITTI_FRAMES + 2)])
    (folder / "calib.txt").write_text(f"P0: {FX} 0 32 0 0 {FY} 24 0 0 0 1 0\nP1: 1 0 0 0 0 1 0 0 0 0 1 0\n")
    file = root / "EndoSLAM" / KITTI_POSES
    file.parent.mkdir(parents=True)
    poses = np.concatenate([ROTATIONS, CENTERS[:, :, None]], axis=2)
    file.write_text("".join(f"{words(poses[i % N])}\n" for i in range(KITTI_FRAMES + 5)))


def tube(root: Path) -> None:
    folder = root / "simcol" / TUBE
    pictures(folder, [f"FrameBuffer_{i:04d}.png" for i in range(N)])
    for i in range(N):
        cv2.imwrite(str(folder / f"Depth_{i:04d}.png"), np.full((HEIGHT, WIDTH), 1000 + i, np.uint16))


@pytest.mark.parametrize(
    ("name", "write"), [("sinus", sinus), ("templeRing", temple), ("fountain-P11", fountain), ("KITTI07", kitti)]
)
def test_every_form_of_poses_is_read_as_the_same_cameras(
    tmp_path: Path, name: str, write: Callable[[Path], None]
) -> None:
    write(tmp_path)
    clip = BY_NAME[name].build(tmp_path, tmp_path / "clip")
    reference = read_reference(clip.folder)
    count = KITTI_FRAMES if name == "KITTI07" else N
    order = np.arange(count) % N
    assert reference.n_frames == count
    assert reference.centers is not None
    assert reference.rotations is not None
    assert reference.centers == pytest.approx(CENTERS[order], abs=1e-9)
    assert reference.rotations == pytest.approx(ROTATIONS[order], abs=1e-9)
    assert reference.focal_px == pytest.approx((FX + FY) / 2)
    assert reference.width_px == WIDTH
    assert len(list(clip.video.iterdir())) == count
    assert clip.video.is_dir()


def test_a_source_without_poses_brings_its_depths(tmp_path: Path) -> None:
    tube(tmp_path)
    clip = BY_NAME["simcol"].build(tmp_path, tmp_path / "clip")
    reference = read_reference(clip.folder)
    assert reference.centers is None
    assert reference.focal_px is None
    depths = [cv2.imread(str(path), cv2.IMREAD_UNCHANGED) for path in clip.depths]
    assert [picture.max() for picture in depths if picture is not None] == [1000 + i for i in range(N)]


def test_a_checkout_that_is_not_what_it_should_be_is_named(tmp_path: Path) -> None:
    source: Source = BY_NAME["templeRing"]
    assert not source.is_there(tmp_path)
    temple(tmp_path)
    folder = tmp_path / "Multiple-View-Stereo" / TEMPLE
    poses = folder / "templeR_par.txt"
    text = poses.read_text()
    poses.write_text("\n".join(text.split("\n")[:-2]))
    with pytest.raises(BadInput, match="6 pictures and 5 poses"):
        source.build(tmp_path, tmp_path / "short")
    poses.write_text(text.replace("500", "wide"))
    with pytest.raises(BadInput, match="poses of templeRing cannot be read"):
        source.build(tmp_path, tmp_path / "words")
    poses.write_text(text)
    (folder / "templeR0001.png").write_text("version https://git-lfs")
    with pytest.raises(BadInput, match="not a picture"):
        source.build(tmp_path, tmp_path / "pointer")
    for picture in folder.glob("*.png"):
        picture.unlink()
    with pytest.raises(BadInput, match="has no data/templeRing"):
        source.build(tmp_path, tmp_path / "none")


def test_a_frame_without_a_pose_stays_without(tmp_path: Path) -> None:
    centers = CENTERS.copy()
    centers[2] = np.nan
    write_reference(tmp_path, Reference("here", N, centers, ROTATIONS))
    read = read_reference(tmp_path)
    assert read.centers is not None
    assert np.isnan(read.centers[2]).all()
    known = np.delete(CENTERS, 2, axis=0)
    assert read.extent == pytest.approx(max(np.linalg.norm(a - b) for a in known for b in known))
    (tmp_path / "poses.json").write_text(
        (tmp_path / "poses.json").read_text().replace('"n_frames": 6', '"n_frames": 7')
    )
    with pytest.raises(BadInput, match="not the reference"):
        read_reference(tmp_path)


def colmap_model(folder: Path, centers: F64, rotations: F64, depths: F64 | None = None) -> None:
    """A sparse model of frames 0, 1, ..., each with points at its depths along its axis, one a row of the picture."""
    model = pycolmap.Reconstruction()
    camera = pycolmap.Camera(
        model="SIMPLE_RADIAL", width=WIDTH // 2, height=HEIGHT // 2, params=[260, 16, 12, 0], camera_id=1
    )
    model.add_camera_with_trivial_rig(camera)
    for i, (center, R) in enumerate(zip(centers, rotations, strict=True)):
        keypoints = [] if depths is None else [np.array([16.0, y + 0.5]) for y in range(len(depths[i]))]
        image = pycolmap.Image(
            name=f"{i:04d}.jpg", points2D=[pycolmap.Point2D(xy) for xy in keypoints], camera_id=1, image_id=i + 1
        )
        model.add_image_with_trivial_frame(image, pycolmap.Rigid3d(pycolmap.Rotation3d(R), center).inverse())
        model.register_frame(model.image(i + 1).frame_id)
        for y in range(len(keypoints)):
            assert depths is not None
            track = pycolmap.Track([pycolmap.TrackElement(i + 1, y)])
            model.add_point3D(center + R @ np.array([0.0, 0.0, depths[i][y]]), track, np.zeros(3, np.uint8))
    (folder / "sparse").mkdir(parents=True)
    model.write(folder / "sparse")


def reference_of(folder: Path, **changes: Any) -> tuple[Clip, Reference]:
    return Clip("here", folder), Reference("here", N, CENTERS, ROTATIONS, 500.0, WIDTH, **changes)


def test_errors_are_told_of_the_extent_after_a_similarity(tmp_path: Path) -> None:
    turn = Rotation.from_rotvec([0.4, -0.2, 0.9]).as_matrix()
    colmap_model(tmp_path, (CENTERS @ turn.T) * 3.0 + 5.0, turn @ ROTATIONS)
    clip, reference = reference_of(tmp_path)
    score = score_peer(tmp_path, clip, reference)
    assert score.registered == N
    assert score.position_percent == pytest.approx((0, 0), abs=1e-6)
    assert score.rotation_deg == pytest.approx((0, 0), abs=1e-6)
    # 260 px on a picture of half the width are 520 px.
    assert score.focal_percent == pytest.approx(4.0)
    assert score.depth_percent is None

    colmap_model(tmp_path / "rolled", CENTERS, ROTATIONS @ Rotation.from_rotvec([0, 0, np.radians(2.0)]).as_matrix())
    score = score_peer(tmp_path / "rolled", clip, reference)
    assert score.position_percent == pytest.approx((0, 0), abs=1e-6)
    assert score.rotation_deg == pytest.approx((2, 2))

    off = CENTERS.copy()
    off[0] += [0.3, 0.0, 0.0]
    colmap_model(tmp_path / "off", off, ROTATIONS)
    score = score_peer(tmp_path / "off", clip, reference)
    assert score.position_percent is not None
    # The similarity shares out a part of the one camera's error.
    assert 0.4 < score.position_percent[1] / (0.3 / reference.extent * 100) < 1.0


def test_frames_without_a_known_pose_do_not_count(tmp_path: Path) -> None:
    moved, centers = CENTERS.copy(), CENTERS.copy()
    moved[1] += 7.0
    centers[1] = np.nan
    colmap_model(tmp_path, moved, ROTATIONS)
    clip, _ = reference_of(tmp_path)
    score = score_peer(tmp_path, clip, Reference("here", N, centers, ROTATIONS))
    assert score.position_percent == pytest.approx((0, 0), abs=1e-6)
    assert score.focal_percent is None


def test_depths_are_compared_after_one_scale(tmp_path: Path) -> None:
    (tmp_path / "depths").mkdir()
    true = np.outer(np.arange(1, N + 1), np.linspace(1000, 3000, HEIGHT // 2)).round()
    for i in range(N):
        rows = np.repeat(true[i], 2)[:, None]
        cv2.imwrite(str(tmp_path / f"depths/{i:04d}.png"), np.repeat(rows, WIDTH, axis=1).astype(np.uint16))
    clip, reference = reference_of(tmp_path)
    colmap_model(tmp_path / "right", CENTERS, ROTATIONS, true * 0.01)
    assert score_peer(tmp_path / "right", clip, reference).depth_percent == pytest.approx((0, 0), abs=1e-6)
    bent = true * 0.01
    bent[: N // 2] *= 1.2
    colmap_model(tmp_path / "bent", CENTERS, ROTATIONS, bent)
    found = score_peer(tmp_path / "bent", clip, reference).depth_percent
    assert found is not None
    assert found[1] == pytest.approx(9.1, abs=0.1)


def test_what_registered_nothing_has_an_empty_score(tmp_path: Path) -> None:
    clip, reference = reference_of(tmp_path)
    assert score_peer(tmp_path, clip, reference) == Score()
    assert score_product(tmp_path, clip, reference) == Score()


def test_a_result_tells_its_frames_by_their_source(tmp_path: Path) -> None:
    """Image 0002.jpg of the run is frame 4 of the clip; what further models hold is counted apart."""
    kept = [0, 2, 4, 5]
    colmap_model(tmp_path, CENTERS[kept], ROTATIONS[kept])
    colmap_model(tmp_path / "models/1", CENTERS[:5], ROTATIONS[:5])
    rows = [f"{i},{source}" for i, source in enumerate([*kept, 1])]
    (tmp_path / "frames.csv").write_text("\n".join(["index,source_index", *rows]))
    clip, reference = reference_of(tmp_path)
    score = score_product(tmp_path, clip, reference)
    assert score.position_percent == pytest.approx((0, 0), abs=1e-6)
    assert (score.registered, score.elsewhere) == (4, 1)
    with pytest.raises(BadInput, match="frame 5"):
        score_product(tmp_path, clip, Reference("another clip", 5))


def test_the_time_of_a_process_is_that_of_all_it_started(tmp_path: Path) -> None:
    burn = "import time\nend = time.process_time() + {}\nwhile time.process_time() < end: pass\n"
    child = "import subprocess, sys\nsubprocess.run([sys.executable, '-c', {!r}], check=True)\n"
    program = child.format(burn.format(0.4)) + 'print(\'{"event": "ended", "key": "extend"}\', flush=True)\n'
    program += "import sys; sys.stderr.write('the end')\n" + burn.format(0.4) + "raise SystemExit(4)"
    ended = run_and_time([sys.executable, "-c", program], tmp_path / "log", {"event": "ended", "key": "extend"})
    assert ended.code == 4
    assert ended.said == "the end"
    assert ended.mark_cpu_s is not None
    assert 0.4 <= ended.mark_cpu_s < ended.cpu_s - 0.3
    never = run_and_time([sys.executable, "-c", "print('{}\\n[1]\\nno')"], tmp_path / "log", {"key": "extend"})
    assert never.mark_cpu_s is None


def test_a_process_ends_at_its_limit(tmp_path: Path) -> None:
    ended = run_and_time([sys.executable, "-c", "import time; time.sleep(60)"], tmp_path / "log", {}, limit_s=0.5)
    assert ended.code == -9


def test_a_run_that_fails_leaves_no_score(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    clip, reference = reference_of(tmp_path)
    monkeypatch.setattr(peer, "__name__", "no.such.module")
    bench = Bench(tmp_path / "out", {})
    with pytest.raises(StageFailed, match="COLMAP failed on here"):
        bench.peer(clip, reference)
    assert not list((tmp_path / "out/results").glob("*/*.json"))


def test_a_run_is_kept_until_program_or_options_change(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    commands: list[list[str]] = []

    def run(command: list[str], log: Path, mark: dict[str, str]) -> Ended:
        commands.append(command)
        out = Path(command[command.index("--out") + 1])
        assert not out.exists(), "a run starts anew"
        colmap_model(out, CENTERS, ROTATIONS)
        (out / "frames.csv").write_text("\n".join(["index,source_index", *(f"{i},{i}" for i in range(N))]))
        flags = [{"code": "few_points", "severity": "warning"}, {"code": "times_made_up", "severity": "info"}]
        (out / "quality.json").write_text(json.dumps({"verdict": "suspect", "flags": flags}))
        assert mark == {"event": "ended", "key": "extend"}
        return Ended(0, 9.0, None if "--set" in command else 4.0, "")

    monkeypatch.setattr(measure, "run_and_time", run)
    clip, reference = reference_of(tmp_path / "clip")
    pictures(clip.video.with_name("pictures"), ["0000.png"])
    bench = Bench(tmp_path / "out", {})
    found = bench.product(clip, reference)
    assert bench.product(clip, reference) == found
    assert len(commands) == 1
    assert commands[0][commands[0].index("--roi") + 1] == "full"
    assert commands[0][commands[0].index("--fps") + 1] == "10", "pictures hold no times"
    assert (found["verdict"], found["flags"], found["cpu_s"]) == ("suspect", ["few_points"], 4.0)
    assert found["score"]["registered"] == N
    told = Bench(tmp_path / "out", {"frames.count": "18"})
    assert told.product(clip, reference)["cpu_s"] == 9.0, "the whole run's, where the sparse model never came"
    assert commands[1][-2:] == ["--set", "frames.count=18"]
    assert bench.product(clip, reference) == found
    monkeypatch.setattr(measure, "program_digest", lambda: "another program")
    bench.product(clip, reference)
    assert len(commands) == 3


def test_the_command_builds_what_is_there_and_prints_a_table(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    temple(tmp_path / "checkouts")
    found = {
        "cpu_s": 12.3,
        "verdict": "suspect",
        "flags": ["few_points"],
        "score": Score(5, 1, (0.5, 1.25), (0.1, 0.2), -2.0).__dict__,
    }
    calls: list[str] = []

    def product(_self: Bench, clip: Clip, _reference: Reference) -> dict[str, Any]:
        calls.append(clip.name)
        return found

    monkeypatch.setattr(measure.Bench, "product", product)
    assert main(["real", str(tmp_path / "out")]) == 2
    assert "there are no clips" in capsys.readouterr().err
    arguments = ["real", str(tmp_path / "out"), "--sources", str(tmp_path / "checkouts")]
    assert main([*arguments, "--make"]) == 0
    assert "no checkout of anitarau/simcol" in capsys.readouterr().err
    assert [path.name for path in (tmp_path / "out/clips").iterdir()] == ["templeRing"]
    assert main([*arguments, "--side", "product"]) == 0
    row = capsys.readouterr().out.strip().split("\n")[-1]
    assert row == (
        "| templeRing | 6 | BladeAtlas | 5 (+ 1) | 0.50 / 1.25 | 0.10 / 0.20 | -2.0 | - | suspect (few_points) | 12 |"
    )
    assert calls == ["templeRing"]
    assert main([*arguments, "--only", "sinus"]) == 2
    assert "there is no clip sinus; there are: templeRing" in capsys.readouterr().err


def test_a_program_without_a_model_has_dashes() -> None:
    row = cells("here", 9, "peer", {"cpu_s": 1.0, "score": json.loads(json.dumps(Score().__dict__))})
    assert row == ["here", "9", "COLMAP", "0", "-", "-", "-", "-", "-", "1"]
