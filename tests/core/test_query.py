"""Questions to a result: pixel to point, point to frames, as library and as commands."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from cli.arguments import parser, with_negative_values
from cli.main import main
from core.errors import BadInput
from core.query import Result, defect_place
from core.surface.ply import Mesh, write_mesh
from tests.core import making_plates as plates
from tests.core.making_plates import CROP, FAR, NEAR

FRAMES = [0, 1, 2, 5, 9]
PLACE = (-0.8, 0.2, NEAR)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("result")
    rows = [f"{i},{10 * i},{0.5 * i}" for i in range(12)]
    (root / "frames.csv").write_text("\n".join(["index,source_index,time_s", *rows]) + "\n")
    crop = [CROP.x0, CROP.y0, CROP.x1, CROP.y1]
    frame = {"width": CROP.source_width, "height": CROP.source_height, "crop": crop, "n_frames": 120, "duration_s": 6.0}
    (root / "summary.json").write_text(json.dumps({"frame": frame}))
    plates.write_model(root / "sparse", FRAMES)
    (root / "mapping").mkdir()
    mesh = plates.plates()
    near = np.linalg.norm(mesh.vertices - PLACE, axis=1) < 0.2
    defect = np.where(near, 3, -1).astype(np.int32)
    write_mesh(root / "mapping" / "mesh_defects.ply", Mesh(mesh.vertices, mesh.faces, extra={"defect_id": defect}))
    records = [{"id": 1, "centroid": (1.0, 1.0, FAR), "model": 1}, {"id": 3, "centroid": PLACE, "model": 0}]
    (root / "mapping" / "defects.json").write_text(json.dumps(records))
    return root


def source_pixel(place: tuple[float, float, float], frame: int) -> np.ndarray:
    return np.asarray(plates.pixel(place, frame) + np.array([CROP.x0, CROP.y0]))


def test_a_pixel_shows_its_point(folder: Path) -> None:
    result = Result(folder)
    shown = result.point_at(20, *source_pixel(PLACE, 2))
    assert shown.point == pytest.approx(PLACE, abs=1e-4)
    assert shown.normal == pytest.approx((0, 0, -1), abs=1e-6)
    assert (shown.frame_index, shown.reason, shown.defect_id) == (2, None, 3)
    assert shown.distance == pytest.approx(np.linalg.norm(np.array(PLACE) - (0.2, 0, 0)), abs=1e-4)
    assert shown.distance is not None
    assert shown.incidence_deg == pytest.approx(np.degrees(np.arccos(NEAR / shown.distance)), abs=0.1)
    beyond = result.point_at(20, *source_pixel((0.6, 0.1, FAR), 2))
    assert beyond.point == pytest.approx((0.6, 0.1, FAR), abs=1e-4)
    assert beyond.defect_id is None


def test_pixels_that_show_nothing_say_why(folder: Path) -> None:
    result = Result(folder)
    assert result.point_at(25, 100, 100).reason == "no_registered_view"
    assert result.point_at(30, 100, 100).reason == "frame_not_registered"
    assert result.point_at(20, 3, 3).reason == "outside_roi"
    small = Result(folder)
    small._surface = type(small._surface)(np.zeros((0, 3)), np.zeros((0, 3), np.int32))
    assert small.point_at(20, 100, 100).reason == "off_surface"


def test_a_point_is_seen_by_its_frames_best_first(folder: Path) -> None:
    visible = Result(folder).visible_frames(np.array(PLACE))
    assert {one.source_index for one in visible} == {10 * frame for frame in FRAMES}
    assert visible[0].source_index == 0, "the nearest camera sees it best"
    assert visible[0].quality == 1.0
    for one in visible:
        assert (one.x, one.y) == pytest.approx(tuple(source_pixel(PLACE, one.frame_index)), abs=0.02)
        assert one.time_s == 0.5 * one.frame_index
    hidden = Result(folder).visible_frames(np.array((-0.3, 0.0, FAR)))
    assert {one.frame_index for one in hidden} == {9}, "the near plate hides it from the others"


def test_the_commands(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    x, y = source_pixel(PLACE, 2)
    assert main(["point", str(folder), "--frame", "20", "--pixel", f"{x},{y}", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["defect_id"] == 3
    assert main(["point", str(folder), "--time", "0.9", "--pixel", f"{x},{y}"]) == 0
    assert "D3" in capsys.readouterr().out
    assert main(["point", str(folder), "--frame", "30", "--pixel", "9,9"]) == 0
    assert "could not be registered" in capsys.readouterr().out
    assert main(["views", str(folder), "--defect", "3", "--limit", "2", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert (found["n_frames"], len(found["frames"])) == (5, 2)
    assert main(["views", str(folder), "--point=-0.8,0.2,4"]) == 0
    assert "5 frames see it" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["point", "--pixel", "1,2"], "say which frame"),
        (["point", "--frame", "20", "--pixel", "1,2,3"], "not 2 numbers"),
        (["point", "--frame", "20", "--time", "1", "--pixel", "1,2"], "not both"),
        (["point", "--frame", "20", "--pixel", "nan,2"], "not finite"),
        (["point", "--frame", "20", "--pixel", "-1,2"], "-1,2 is outside the frame: 0,0 to 360,260"),
        (["point", "--frame", "20", "--pixel", "1,260.5"], "outside the frame: 0,0 to 360,260"),
        (["point", "--frame", "-1", "--pixel", "1,2"], "no frame -1: 0 to 119"),
        (["point", "--frame", "120", "--pixel", "1,2"], "no frame 120: 0 to 119"),
        (["point", "--time", "-0.1", "--pixel", "1,2"], "-0.1 s is outside the video: 0 to 6 s"),
        (["point", "--time", "6.5", "--pixel", "1,2"], "6.5 s is outside the video: 0 to 6 s"),
        (["point", "--time", "nan", "--pixel", "1,2"], "nan s is outside the video"),
        (["point", "--frame", "20", "--pixel", "1,2", "--model", "-1"], "no model -1; there are 0"),
        (["point", "--frame", "20", "--pixel", "1,2", "--model", "7"], "no model 7; there are 0"),
        (["views"], "say which place"),
        (["views", "--defect", "3", "--point", "1,2,3"], "say which place"),
        (["views", "--defect", "8"], "there is no defect 8; there are D1, D3"),
        (["views", "--defect", "dent"], "'dent' is no defect"),
        (["views", "--defect", "-3"], "'-3' is no defect"),
        (["views", "--defect", "D3", "--model", "1"], "D3 is in model 0, not in model 1"),
        (["views", "--defect", "D1"], "no model 1; there are 0"),
        (["views", "--point", "1,2"], "not 3 numbers"),
        (["views", "--point", "-inf,0,4"], "not finite"),
        (["views", "--point", "100,0,4"], "which spans x -4 to 4, y -3 to 3, z 4 to 6"),
        (["views", "--point", "1,1,6", "--limit", "0"], "at least 1"),
        (["views", "--point", "1,1,6", "--limit", "-2"], "at least 1"),
        (["views", "--point", "1,1,6", "--model", "-2"], "no model -2"),
    ],
)
def test_questions_that_make_no_sense(
    folder: Path, capsys: pytest.CaptureFixture[str], words: list[str], said: str
) -> None:
    assert main([words[0], str(folder), *words[1:]]) == 2
    printed = capsys.readouterr()
    assert said in printed.err
    assert (printed.err.count("\n"), printed.out) == (1, "")


@pytest.mark.parametrize("words", [["--point", "-0.8,0.2,4"], ["--point=-0.8,0.2,4"], ["--poi", "-.8,0.2,4"]])
def test_a_place_may_begin_with_a_negative_number(
    folder: Path, capsys: pytest.CaptureFixture[str], words: list[str]
) -> None:
    assert main(["views", str(folder), *words]) == 0
    assert "5 frames see it" in capsys.readouterr().out
    assert main(["views", *words, "--json", str(folder)]) == 0
    assert json.loads(capsys.readouterr().out)["n_frames"] == 5


def test_negative_values_are_joined_with_their_option_only() -> None:
    words = ["point", "R", "--pixel", "-1,2", "--frame", "-3", "--json", "--", "-4"]
    assert with_negative_values(words) == ["point", "R", "--pixel=-1,2", "--frame=-3", "--json", "--", "-4"]
    parsed = parser().parse_args(["point", "R", "--pixel", "-1,2", "--time", "-1e3"])
    assert (parsed.pixel, parsed.time) == ("-1,2", -1000.0)


def test_a_defect_is_called_by_its_number_or_its_name(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    answers = []
    for name in ("3", "D3", "d3"):
        assert main(["views", str(folder), "--defect", name, "--json"]) == 0
        answers.append(capsys.readouterr().out)
    assert len(set(answers)) == 1
    assert defect_place(folder, 1)[1] == 1, "a place is in the world frame of its own model"


def test_a_place_is_moved_to_the_surface_only_with_a_word(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["views", str(folder), "--point", "-0.8,0.2,3.99"]) == 0
    assert "nearest" not in capsys.readouterr().out, "nearer than the surface's own points are to each other"
    assert main(["views", str(folder), "--point", "-0.8,0.2,3.8"]) == 0
    said = capsys.readouterr().out.splitlines()[0]
    assert said.startswith("the nearest point of the surface is -0.80000, 0.20000, 4.00000: 0.20000 from the place")
    assert main(["views", str(folder), "--point", "-0.8,0.2,3.8", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["point"] == pytest.approx([-0.8, 0.2, NEAR], abs=1e-6)
    assert found["distance"] == pytest.approx(0.2, abs=1e-6)
    assert found["spacing"] == pytest.approx(plates.SPACING, rel=0.3)


def test_the_frame_that_a_time_led_to_says_its_own_time(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    x, y = source_pixel(PLACE, 2)
    assert main(["point", str(folder), "--time", "1.2", "--pixel", f"{x},{y}"]) == 0
    assert "frame 20 at 1.000 s" in capsys.readouterr().out
    assert main(["point", str(folder), "--time", "1.2", "--pixel", f"{x},{y}", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["time_s"] == 1.0


def test_a_summary_without_the_videos_length_allows_what_took_part(folder: Path, tmp_path: Path) -> None:
    old = shutil.copytree(folder, tmp_path / "old")
    frame = json.loads((old / "summary.json").read_text())["frame"]
    (old / "summary.json").write_text(json.dumps({"frame": {k: frame[k] for k in ("width", "height", "crop")}}))
    with pytest.raises(BadInput, match="0 to 110"):
        Result(old).point_at(111, 1, 1)
    with pytest.raises(BadInput, match=r"0 to 5\.5 s"):
        Result(old).frame_at(5.6)


@pytest.mark.parametrize(
    ("broken", "named"), [("sparse/cameras.bin", "sparse"), ("mapping/mesh_defects.ply", "mesh_defects.ply")]
)
def test_what_cannot_be_read_is_named(folder: Path, tmp_path: Path, broken: str, named: str) -> None:
    result = shutil.copytree(folder, tmp_path / "broken")
    (result / broken).write_bytes(b"")
    with pytest.raises(BadInput) as caught:
        Result(result)
    assert caught.value.where == named


def test_a_folder_that_is_no_result(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match=r"has no frames\.csv"):
        Result(tmp_path)
    with pytest.raises(BadInput, match=r"defects\.json"):
        defect_place(tmp_path, 0)


@pytest.fixture
def two_videos(folder: Path, tmp_path: Path) -> Path:
    """The same result, with frames from 5 on in a second video of which every tenth took part as well."""
    root = tmp_path / "two"
    shutil.copytree(folder, root)
    rows = [f"{i},{10 * (i % 5)},{0.5 * (i % 5)},{int(i >= 5)}" for i in range(10)]
    (root / "frames.csv").write_text("\n".join(["index,source_index,time_s,video", *rows]) + "\n")
    summary = json.loads((root / "summary.json").read_text())
    summary["frame"]["videos"] = [{"n_frames": 50, "duration_s": 2.5}, {"n_frames": 70, "duration_s": 3.5}]
    (root / "summary.json").write_text(json.dumps(summary))
    return root


def test_a_question_names_its_video(two_videos: Path, capsys: pytest.CaptureFixture[str]) -> None:
    result = Result(two_videos)
    x, y = source_pixel(PLACE, 9)
    assert result.point_at(40, x, y, 1).frame_index == 9
    assert result.point_at(40, x, y).frame_index == 4
    assert result.frame_at(3.4, 1) == 40
    assert {one.video for one in result.visible_frames(np.array(PLACE))} == {0, 1}
    assert {one.frame_index for one in result.visible_frames(np.array(PLACE), 1)} <= {5, 9}
    assert main(["point", str(two_videos), "--video", "1", "--time", "0", "--pixel", f"{x},{y}", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["video"] == 1


def test_what_is_outside_a_video_is_told_with_its_number(two_videos: Path) -> None:
    result = Result(two_videos)
    with pytest.raises(BadInput, match=r"3 s is outside video 0: 0 to 2\.5 s"):
        result.frame_at(3.0)
    with pytest.raises(BadInput, match="video 1 has no frame 70: 0 to 69"):
        result.point_at(70, 1, 1, 1)
    for ask in (lambda: result.frame_at(0.0, 2), lambda: result.visible_frames(np.array(PLACE), -1)):
        with pytest.raises(BadInput, match=r"there is no video -?[12]: 0 to 1") as caught:
            ask()
        assert caught.value.where == "--video"
