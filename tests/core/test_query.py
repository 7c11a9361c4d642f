"""Questions to a result: pixel to point, point to frames, as library and as commands."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

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
    frame = {"width": CROP.source_width, "height": CROP.source_height, "crop": crop}
    (root / "summary.json").write_text(json.dumps({"frame": frame}))
    plates.write_model(root / "sparse", FRAMES)
    (root / "mapping").mkdir()
    mesh = plates.plates()
    near = np.linalg.norm(mesh.vertices - PLACE, axis=1) < 0.2
    defect = np.where(near, 3, -1).astype(np.int32)
    write_mesh(root / "mapping" / "mesh_defects.ply", Mesh(mesh.vertices, mesh.faces, extra={"defect_id": defect}))
    (root / "mapping" / "defects.json").write_text(json.dumps([{"id": 3, "centroid": PLACE}]))
    return root


def source_pixel(place: tuple[float, float, float], frame: int) -> np.ndarray:
    return plates.pixel(place, frame) + np.array([CROP.x0, CROP.y0])


def test_a_pixel_shows_its_point(folder: Path) -> None:
    result = Result(folder)
    shown = result.point_at(20, *source_pixel(PLACE, 2))
    assert shown.point == pytest.approx(PLACE, abs=1e-4)
    assert shown.normal == pytest.approx((0, 0, -1), abs=1e-6)
    assert (shown.frame_index, shown.reason, shown.defect_id) == (2, None, 3)
    assert shown.distance == pytest.approx(np.linalg.norm(np.array(PLACE) - (0.2, 0, 0)), abs=1e-4)
    assert shown.incidence_deg == pytest.approx(np.degrees(np.arccos(NEAR / shown.distance)), abs=0.1)
    beyond = result.point_at(20, *source_pixel((0.6, 0.1, FAR), 2))
    assert (beyond.point, beyond.defect_id) == (pytest.approx((0.6, 0.1, FAR), abs=1e-4), None)


def test_pixels_that_show_nothing_say_why(folder: Path) -> None:
    result = Result(folder)
    assert result.point_at(25, 100, 100).reason == "no_registered_view"
    assert result.point_at(30, 100, 100).reason == "frame_not_registered"
    assert result.point_at(20, 3, 3).reason == "outside_roi"
    small = Result(folder)
    small._surface = type(small._surface)(np.zeros((0, 3)), np.zeros((0, 3), np.int32))
    assert small.point_at(20, 100, 100).reason == "off_surface"


def test_a_point_is_seen_by_its_frames_best_first(folder: Path) -> None:
    seeing = Result(folder).frames_seeing(np.array(PLACE))
    assert {one.source_index for one in seeing} == {10 * frame for frame in FRAMES}
    assert seeing[0].source_index == 0, "the nearest camera sees it best"
    assert seeing[0].quality == 1.0
    for one in seeing:
        assert (one.x, one.y) == pytest.approx(tuple(source_pixel(PLACE, one.frame_index)), abs=0.02)
        assert one.time_s == 0.5 * one.frame_index
    hidden = Result(folder).frames_seeing(np.array((-0.3, 0.0, FAR)))
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
        (["views"], "say which place"),
        (["views", "--defect", "3", "--point", "1,2,3"], "say which place"),
        (["views", "--defect", "8"], "there is no defect 8"),
    ],
)
def test_questions_that_make_no_sense(
    folder: Path, capsys: pytest.CaptureFixture[str], words: list[str], said: str
) -> None:
    assert main([words[0], str(folder), *words[1:]]) == 2
    assert said in capsys.readouterr().err


def test_a_folder_that_is_no_result(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match=r"has no frames\.csv"):
        Result(tmp_path)
    with pytest.raises(BadInput, match=r"defects\.json"):
        defect_place(tmp_path, 0)
