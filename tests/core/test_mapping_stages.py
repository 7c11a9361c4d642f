"""`map_defects`, `timeline` and `gallery` one after the other, on a plane whose points and cameras are known.

Six cameras look along +z at the plane z = 4 and step along x; the images are the whole 160x128 frames.
"""

from __future__ import annotations

import hashlib
import json
import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pycolmap
import pytest
import trimesh

from core.products.contract import Facts
from core.settings import Settings, make_settings
from core.stage import StageTask
from core.stages import gallery, map_defects, timeline
from core.surface.ply import Mesh, read_mesh, write_mesh
from core.video.probe import probe_video
from core.videos import Recording
from tests.core.making_films import ffmpeg, ffmpeg_pixels
from tests.core.making_videos import every_ms, make_video

DEPTH, FOCAL, N_FRAMES, STEP = 4.0, 100.0, 8, 0.1
REGISTERED = [0, 1, 2, 3, 4, 5]
SETTINGS = make_settings(
    "default",
    {
        "mapping.method": "thesis",
        "timeline.radius_fraction": 0.04,  # 0.31 units, so that the place seen two frames late joins its defect
        "gallery.render_width_px": 160,
        "gallery.render_height_px": 120,
        "gallery.max_frames": 3,
    },
)


def box_around(place: tuple[float, float], frame: int, half_px: float = 9.0) -> list[float]:
    """Normalised box of a place of the plane as `frame` sees it."""
    x = FOCAL * (place[0] - STEP * frame) / DEPTH + 80
    y = FOCAL * place[1] / DEPTH + 64
    return [(x - half_px) / 160, (y - half_px) / 128, (x + half_px) / 160, (y + half_px) / 128]


A, B = (0.5, 0.4), (-1.2, -0.6)
DETECTIONS = [
    (0, "dent", box_around(A, 0), 0.08 * 0),
    (0, "nick", box_around(B, 0), 0.08 * 0),
    (2, "dent", box_around(A, 2), 0.08 * 2),
    (3, "dent", [0.0, 0.0, 0.01, 0.01], 0.08 * 3),
    (7, "dent", box_around(A, 7), 0.08 * 7),
    (None, "dent", box_around(A, 0), 50.0),
]


def write(path: Path, value: Any) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(value), encoding="utf-8")


def plane(columns: int = 121, rows: int = 101) -> Mesh:
    x, y = np.meshgrid(np.linspace(-3, 3, columns), np.linspace(-2.5, 2.5, rows))
    index = np.arange(x.size).reshape(x.shape)
    a, b, c, d = (part.ravel() for part in (index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]))
    faces = np.vstack([np.stack([a, c, b], axis=1), np.stack([a, d, c], axis=1)]).astype(np.int32)
    vertices = np.stack([x.ravel(), y.ravel(), np.full(x.size, DEPTH)], axis=1)
    support = np.ones(x.size, np.float32)
    return Mesh(vertices, faces, np.full((x.size, 3), 90, np.uint8), extra={"support": support})


def sparse_model(folder: Path, registered: Sequence[int] = REGISTERED) -> None:
    model = pycolmap.Reconstruction()
    params = [FOCAL, FOCAL, 80, 64]
    model.add_camera_with_trivial_rig(
        pycolmap.Camera(model="PINHOLE", width=160, height=128, params=params, camera_id=1)
    )
    grid = np.stack(np.meshgrid(np.arange(-3, 3, 0.12), np.arange(-2.4, 2.4, 0.12)), axis=-1).reshape(-1, 2)
    points = np.column_stack([grid, np.full(len(grid), DEPTH)])
    ids = [model.add_point3D(point, pycolmap.Track(), np.zeros(3, np.uint8)) for point in points]
    for frame in registered:
        in_camera = points - [STEP * frame, 0, 0]
        xy = FOCAL * in_camera[:, :2] / DEPTH + [80, 64]
        seen = np.flatnonzero(((xy > 0) & (xy < [160, 128])).all(axis=1))
        image = pycolmap.Image(
            name=f"{frame:04d}.jpg",
            points2D=pycolmap.Point2DList([pycolmap.Point2D(xy[i]) for i in seen]),
            camera_id=1,
            image_id=frame + 1,
        )
        pose = pycolmap.Rigid3d(np.column_stack([np.eye(3), [-STEP * frame, 0, 0]]))
        model.add_image_with_trivial_frame(image, pose)
        for k, i in enumerate(seen):
            model.add_observation(ids[i], pycolmap.TrackElement(frame + 1, k))
    folder.mkdir(parents=True)
    model.write_binary(folder)


@pytest.fixture(scope="module")
def inputs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("inputs")
    write_inputs(root)
    sparse_model(root / "extend" / "model")
    write(root / "extend" / "registered.json", REGISTERED)
    (root / "mesh").mkdir()
    write_mesh(root / "mesh" / "mesh_poisson.ply", plane())
    (root / "fuse").mkdir()
    return root


def write_inputs(root: Path) -> None:
    """The video, and the results of the stages before the model."""
    (root / "probe").mkdir()
    probe_video(make_video(root / "video.mp4", every_ms(80, N_FRAMES))).write(root / "probe")
    frames = [
        {"index": i, "source_index": i, "pts": i, "time_s": 0.08 * i, "sha256": "", "role": "both"}
        for i in range(N_FRAMES)
    ]
    crop = {"x0": 0, "y0": 0, "x1": 160, "y1": 128, "source_width": 160, "source_height": 128}
    write(root / "frames" / "frames.json", frames)
    write(root / "frames" / "crop.json", crop)
    write(root / "frames" / "damaged.json", [6])
    rows = [
        {
            "id": i,
            "key": f"{time_s:.4f}",
            "time_s": time_s,
            "label": label,
            "score": 0.5 + 0.05 * i,
            "box": box,
            "polygon": None,
            "track_id": None,
            "source_index": source,
        }
        for i, (source, label, box, time_s) in enumerate(DETECTIONS)
    ]
    write(root / "annotations" / "detections.json", rows)


def run_all(inputs: Path, out: Path, settings: Settings = SETTINGS) -> tuple[Path, dict[str, Facts]]:
    """The three stages; gives the folder of their results and their facts."""
    folders = {path.name: path for path in inputs.iterdir() if path.is_dir()}
    facts: dict[str, Facts] = {}
    for name, stage in (("map_defects", map_defects), ("timeline", timeline), ("gallery", gallery)):
        folders[name] = out / name
        folders[name].mkdir(parents=True)
        task = StageTask(
            name, {}, settings, dict(folders), dict(facts), (Recording(inputs / "video.mp4"),), folders[name]
        )
        facts[name] = stage.run(task).facts
    return out, facts


@pytest.fixture(scope="module")
def done(inputs: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, Facts]]:
    return run_all(inputs, tmp_path_factory.mktemp("out"))


def rows_of(out: Path, name: str) -> list[dict[str, Any]]:
    rows: list[dict[str, Any]] = json.loads((out / "timeline" / name).read_text(encoding="utf-8"))
    return rows


def test_every_detection_has_its_outcome(done: tuple[Path, dict[str, Facts]]) -> None:
    rows = rows_of(done[0], "detections.json")
    assert [(row["outcome"], row["reason"]) for row in rows] == [
        ("mapped", None),
        ("mapped", None),
        ("mapped", None),
        ("unplaced", "no_support"),
        ("mapped", None),  # frame 7 is not registered; frame 5, 0.16 s before it, is
        ("unplaced", "no_frame"),
    ]
    assert [row["frame_index"] for row in rows] == [0, 0, 2, 3, 5, None]
    assert [row["defect_id"] for row in rows][:3] == [0, 1, 0]


def test_places_are_where_the_boxes_point(done: tuple[Path, dict[str, Facts]]) -> None:
    rows = rows_of(done[0], "detections.json")
    for row, place in zip(rows[:3], (A, B, A), strict=True):
        assert (row["x"], row["y"], row["z"]) == pytest.approx((*place, DEPTH), abs=0.08)
    # Seen in frame 5 instead of frame 7, the box lies 0.2 units beside the place.
    assert rows[4]["x"] == pytest.approx(A[0] - 2 * STEP, abs=0.08)


def test_the_surface_is_red_there_and_nowhere_else(done: tuple[Path, dict[str, Facts]]) -> None:
    out, facts = done
    mesh = read_mesh(out / "timeline" / "mesh_defects.ply")
    assert any("world frame" in comment for comment in mesh.comments)
    assert "unit: model" in mesh.comments
    defect = mesh.extra["defect_id"]
    assert mesh.extra["support"].min() == 1
    assert mesh.colors is not None
    away = np.linalg.norm(mesh.vertices[:, None, :2] - np.array([A, B]), axis=2)
    assert (defect[away.min(axis=1) > 1.0] == -1).all()
    assert (mesh.colors[defect < 0] == 90).all()
    for number, place in enumerate((A, B)):
        middle = np.linalg.norm(mesh.vertices[:, :2] - place, axis=1) < 0.2
        assert (defect[middle] == number).mean() > 0.6
        assert mesh.colors[middle, 0].max() > 200
    assert facts["timeline"]["n_defects"] == 2
    points = read_mesh(out / "map_defects" / "defect_points.ply")
    assert len(points.vertices) == facts["map_defects"]["unique_support_points"]


def test_defects_know_their_frames_and_faces(done: tuple[Path, dict[str, Facts]]) -> None:
    out, _ = done
    first, second = rows_of(out, "defects.json")
    assert (first["label"], second["label"]) == ("dent", "nick")
    assert (first["persistence"]["k"], first["persistence"]["n"]) == (3, 6)
    assert {frame["frame_index"] for frame in first["frames"] if frame["detected"]} == {0, 2, 5}
    mesh = read_mesh(out / "timeline" / "mesh_defects.ply")
    covered = mesh.faces[first["faces"]]
    assert ((mesh.extra["defect_id"][covered] == 0).sum(axis=1) >= 2).all()
    events = rows_of(out, "timeline.json")
    assert [(event["n_detections"], event["n_frames"]) for event in events] == [(3, 3), (1, 1)]


def test_the_glb_shows_the_same_surface(done: tuple[Path, dict[str, Facts]]) -> None:
    out, _ = done
    mesh = read_mesh(out / "timeline" / "mesh_defects.ply")
    read = trimesh.load(out / "timeline" / "mesh_defects.glb", force="mesh", process=False)
    assert read.vertices == pytest.approx(mesh.vertices * [1, -1, -1], abs=1e-5)
    assert (read.vertex_attributes["_DEFECT_ID"].ravel() == mesh.extra["defect_id"]).all()


def test_the_gallery_has_its_pictures(inputs: Path, done: tuple[Path, dict[str, Facts]]) -> None:
    out, facts = done
    folder = out / "gallery"
    assert facts["gallery"] == {"n_images": 3, "n_frames": 4}
    html = (folder / "index.html").read_text(encoding="utf-8")
    pictures = sorted(path.name for path in folder.glob("frame_*.jpg"))
    assert len([name for name in pictures if f'src="{name}"' in html]) == 3
    frames = json.loads((inputs / "frames" / "frames.json").read_text(encoding="utf-8"))
    rows = html.split("<tbody>")[1].split("</tbody>")[0].split("</tr>")
    for defect in rows_of(out, "defects.json"):
        best = frames[defect["frames"][0]["frame_index"]]
        link = f'<a href="frame_{best["source_index"]:06d}.jpg">{best["time_s"]:.2f} s</a>'
        assert f"frame_{best['source_index']:06d}.jpg" in pictures
        (row,) = (one for one in rows if f'data-defect="{defect["id"]}"' in one)
        assert link in row
    assert all(f'href="{name}"' in html for name in pictures), "every picture is shown or linked"
    for name in ("mesh_1.png", "mesh_2.png"):
        picture = cv2.imread(str(folder / name))
        assert picture is not None
        assert picture.shape == (120, 160, 3)
        blue, green, red = (picture[..., i].astype(int) for i in range(3))
        assert ((red > 130) & (green < 90) & (blue < 90)).sum() > 20, "red spots are seen"


def test_the_same_input_gives_the_same_bytes(inputs: Path, done: tuple[Path, dict[str, Facts]], tmp_path: Path) -> None:
    again, facts = run_all(inputs, tmp_path)
    assert facts == done[1]

    def digests(root: Path) -> dict[str, str]:
        files = sorted(path for path in root.rglob("*") if path.is_file())
        return {path.relative_to(root).as_posix(): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}

    assert digests(again) == digests(done[0])


def test_without_detections_every_file_exists(inputs: Path, tmp_path: Path) -> None:
    empty = tmp_path / "inputs"
    empty.mkdir()
    for path in inputs.iterdir():
        (empty / path.name).symlink_to(path)
    (empty / "annotations").unlink()
    write(empty / "annotations" / "detections.json", [])
    out, facts = run_all(empty, tmp_path / "out")
    assert facts["map_defects"]["support_mean"] is None
    assert facts["gallery"]["n_images"] == 0
    assert (rows_of(out, "timeline.json"), rows_of(out, "defects.json")) == ([], [])
    assert (read_mesh(out / "timeline" / "mesh_defects.ply").extra["defect_id"] == -1).all()
    assert (out / "timeline" / "mesh_defects.glb").stat().st_size > 1000
    assert len(read_mesh(out / "map_defects" / "defect_points.ply").vertices) == 0
    assert (out / "gallery" / "mesh_1.png").exists()


@pytest.mark.tool("ffmpeg")
def test_pictures_of_the_gallery_are_deinterlaced_and_square(inputs: Path, tmp_path: Path) -> None:
    """A film of as many frames, each of two fields, with pixels of 4:3."""
    root = tmp_path / "inputs"
    shutil.copytree(inputs, root)
    source = make_video(tmp_path / "source.mp4", every_ms(40, 2 * N_FRAMES))
    fields = (
        "-vf",
        "scale=120:128,setsar=4/3,interlace=lowpass=off",
        "-c:v",
        "libx264",
        "-qp",
        "4",
        "-x264-params",
        "tff=1",
    )
    film = ffmpeg(tmp_path / "fields.mp4", "-i", source, *fields)
    film.replace(root / "video.mp4")
    table = probe_video(root / "video.mp4")
    assert (table.info.width, table.info.interlaced_frames, table.info.n_frames) == (160, N_FRAMES, N_FRAMES)
    table.write(root / "probe")
    out, _ = run_all(root, tmp_path / "out")
    shown = ffmpeg_pixels(root / "video.mp4", "v:0", 160, 128, "bwdif=mode=send_frame,scale=iw*sar:ih,setsar=1")
    combed = ffmpeg_pixels(root / "video.mp4", "v:0", 160, 128, "scale=iw*sar:ih,setsar=1")
    drawn = sorted((out / "gallery").glob("frame_*.jpg"))
    assert drawn
    for path in drawn:
        coded = cv2.imread(str(path))
        assert coded is not None
        image, frame = coded[..., ::-1].astype(int), int(path.stem[6:])
        right, wrong = (np.abs(image - films[frame]).mean(axis=2) for films in (shown, combed))
        apart = np.abs(shown[frame].astype(int) - combed[frame]).mean(axis=2) > 8
        assert apart.sum() > 100
        assert right[apart].mean() < 0.6 * wrong[apart].mean(), "lines and letters are drawn on few of the pixels"
