"""The pages of whole results: those of tests/data/results, and those of results that had none."""

from __future__ import annotations

import base64
import json
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from core.errors import BadInput
from core.outputs import DEFECT_SURFACE, SURFACE
from core.report.build import Report, build_report
from core.surface.ply import read_mesh, write_mesh
from core.viewer.deliver import bundle, write_page
from core.viewer.document import ViewerSource, page_of, viewer_document
from core.viewer.published import build_pages
from tests.core.making_record import failed_record, full_record
from tests.core.making_results import RESULTS, make, opened
from tests.core.viewer.test_surface import Glb
from tests.old_release import unpack

PAGES = ("two_models/viewer", "two_models/models/1/viewer", "refused/viewer")


def document_of(page: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((page / "viewer.json").read_text(encoding="utf-8"))
    return found


def size_of(picture: Path) -> tuple[int, int]:
    read = cv2.imread(str(picture))
    assert read is not None
    return read.shape[1], read.shape[0]


@pytest.mark.parametrize("name", PAGES)
def test_every_picture_is_there_at_its_size(name: str) -> None:
    page = RESULTS / name
    shown = document_of(page)
    assert len(shown["frames"]) == 8
    for frame in shown["frames"]:
        width, height = size_of(page / frame["picture"])
        assert (width, height) == (160 * frame["picture_scale"], 128 * frame["picture_scale"])
        if not frame["picture"].startswith("../"):
            assert (page / frame["picture"]).resolve().parent.parent == page.resolve()
    best = {index for defect in shown["defects"] for index in defect["best_frames"]}
    detected = {one["frame"] for one in shown["detections"]} - {None}
    for index in best | detected:
        assert shown["frames"][index]["picture_scale"] == 1 or index not in best
    sprite = shown["sprite"]
    rows = -(-sprite["count"] // sprite["columns"])
    assert size_of(page / sprite["file"]) == (sprite["columns"] * sprite["width"], rows * sprite["height"])
    assert sorted(frame["tile"] for frame in shown["frames"]) == list(range(sprite["count"]))


@pytest.mark.parametrize("name", PAGES)
def test_the_script_says_what_the_document_and_the_surface_say(name: str) -> None:
    page = RESULTS / name
    text = (page / "data.js").read_text(encoding="ascii")
    viewer, _, surface = text.removeprefix("window.BLADEATLAS = {viewer: ").rpartition(", surface: ")
    assert json.loads(viewer) == document_of(page)
    encoded = json.loads(surface.removesuffix("};\n"))
    if document_of(page)["surface"] is None:
        assert encoded is None
    else:
        assert base64.b64decode(encoded) == (page / "surface.glb").read_bytes()


@pytest.mark.parametrize("name", PAGES[:2])
def test_poses_and_lens_lead_back_to_the_pixels(name: str) -> None:
    """What the page computes: a defect's place, seen by the pose and lens of its best view, is where it was seen."""
    page = RESULTS / name
    shown = document_of(page)
    fx, fy, cx, cy = shown["camera"]["params"]
    assert shown["camera"]["model"] == "PINHOLE"
    asked = 0
    for defect in shown["defects"]:
        pose = np.array(shown["frames"][defect["best"]["frame"]]["cam_from_world"]).reshape(3, 4)
        x, y, z = pose @ [*defect["centroid"], 1.0]
        pixel = (fx * x / z + cx, fy * y / z + cy)
        boxes = [
            one["box"]
            for one in shown["detections"]
            if one["frame"] == defect["best"]["frame"] and one["defect"] == defect["id"]
        ]
        asked += len(boxes)
        assert all(box[0] <= pixel[0] <= box[2] and box[1] <= pixel[1] <= box[3] for box in boxes)
        glb = Glb(page / "surface.glb")
        middle = glb.positions(defect["node"]).mean(axis=0)
        assert middle == pytest.approx(defect["centroid"], abs=0.3)
    assert asked >= (name == PAGES[0]) * 2
    assert shown["up"] == pytest.approx([0, -1, 0])


def test_a_surface_that_is_turned_over_has_the_same_page(tmp_path: Path) -> None:
    pages = []
    for name in ("as_it_is", "turned_over"):
        folder = opened("one_model", tmp_path / name)
        if name == "turned_over":
            for surface in (SURFACE, DEFECT_SURFACE):
                mesh = read_mesh(folder / surface)
                turned = replace(mesh, faces=np.ascontiguousarray(mesh.faces[:, ::-1]))
                write_mesh(folder / surface, turned, mesh.comments)
        build_pages(folder)
        files = {path.relative_to(folder): path for path in sorted((folder / "viewer").rglob("*")) if path.is_file()}
        pages.append({str(name): path.read_bytes() for name, path in files.items()})
        assert "viewer/surface.glb" in pages[-1]
    assert pages[0] == pages[1]


def test_models_lead_to_each_other() -> None:
    first, second = (document_of(RESULTS / name) for name in PAGES[:2])
    for name, shown, other in ((PAGES[0], first, 1), (PAGES[1], second, 0)):
        assert shown["model"]["count"] == 2
        assert [one["index"] for one in shown["models"]] == [other]
        target = (RESULTS / name / shown["models"][0]["href"]).resolve()
        assert target.parent == (RESULTS / PAGES[other]).resolve()
    assert {one["model"] for one in first["defects"]} == {0}
    assert {one["model"] for one in second["defects"]} == {1}
    assert not {one["id"] for one in first["defects"]} & {one["id"] for one in second["defects"]}
    assert {event["defect_id"] for event in second["events"]} == {one["id"] for one in second["defects"]}
    summary = json.loads((RESULTS / "two_models/summary.json").read_text(encoding="utf-8"))
    assert first["fingerprint"] == second["fingerprint"] == summary["fingerprint"]
    registered = [index for index, frame in enumerate(second["frames"]) if frame["registered"]]
    assert registered == [5, 6, 7]
    assert second["frames"][0]["reason"] == "in_another_model"


def test_a_refused_run_shows_its_frames_and_says_why() -> None:
    shown = document_of(RESULTS / "refused/viewer")
    assert shown["verdict"] == "refused"
    assert shown["surface"] is None
    assert "no case has a model" in shown["surface_reason"]
    assert {frame["reason"] for frame in shown["frames"]} == {"no_model"}
    assert not any(frame["cam_from_world"] for frame in shown["frames"])
    assert len(shown["detections"]) == 6
    assert {one["state"] for one in shown["detections"]} == {"unplaced"}
    assert not any(one["point"] for one in shown["detections"])
    assert all(one["reason"] in shown["reasons"] for one in shown["detections"])


def test_the_committed_result_is_what_the_stages_make_today(tmp_path: Path) -> None:
    new, committed = tmp_path / "new", RESULTS / "two_models"
    make("two_models", new)
    for page in ("viewer", "models/1/viewer"):
        # The fingerprint holds the versions of all stages: a result that is the same may have another.
        today, before = ({**document_of(root / page), "fingerprint": None} for root in (new, committed))
        assert today == before, page
        assert (new / page / "surface.glb").read_bytes() == (committed / page / "surface.glb").read_bytes(), page


def test_a_result_without_a_page_gets_the_same_one_but_for_its_pictures(tmp_path: Path) -> None:
    for name in ("two_models", "refused"):
        folder = tmp_path / name
        shutil.copytree(RESULTS / name, folder, ignore=shutil.ignore_patterns("viewer"))
        said = build_pages(folder)
        assert len(said) == 1
        assert "--video" in said[0]
        for page in ("viewer", "models/1/viewer") if name == "two_models" else ("viewer",):
            shown, before = document_of(folder / page), document_of(RESULTS / name / page)
            assert {path.name for path in (folder / page).iterdir()} >= {*bundle(), "viewer.json", "data.js"}
            assert shown["pictures_reason"] == said[0]
            assert not any(frame["picture"] for frame in shown["frames"])
            for key in ("defects", "events", "camera", "surface", "models", "up", "verdict"):
                assert shown[key] == before[key], key
            poses = [frame["cam_from_world"] for frame in shown["frames"]]
            assert poses == [frame["cam_from_world"] for frame in before["frames"]]
        assert not list(folder.glob(".viewer-*"))


def test_a_result_of_the_first_release_gets_a_page(tmp_path: Path) -> None:
    folder = unpack("result", tmp_path)
    said = build_pages(folder)
    shown = document_of(folder / "viewer")
    records = json.loads((folder / "mapping/defects.json").read_text(encoding="utf-8"))
    assert [one["id"] for one in shown["defects"]] == [one["id"] for one in records]
    assert shown["surface"] is not None or any("surface" in text for text in said)
    assert len(shown["detections"]) == len(json.loads((folder / "mapping/detections.json").read_text(encoding="utf-8")))


@pytest.mark.parametrize(
    ("name", "told"), [("mapping/defects.json", "mapping/defects.json"), ("frames.csv", "frames.csv")]
)
def test_what_is_missing_is_named(tmp_path: Path, name: str, told: str) -> None:
    folder = opened("refused", tmp_path / "refused")
    (folder / name).unlink()
    with pytest.raises(BadInput, match=told):
        build_pages(folder)


def test_another_video_is_refused(tmp_path: Path) -> None:
    folder = opened("two_models", tmp_path / "two")
    film = tmp_path / "other.mp4"
    film.write_bytes(b"another film")
    with pytest.raises(BadInput, match="hash"):
        build_pages(folder, [film])
    with pytest.raises(BadInput, match="not there"):
        build_pages(folder, [tmp_path / "none.mp4"])


def report_with(label: str) -> Report:
    report = build_report(full_record())
    rows = [{**row, "label": label} for row in report.detections]
    return Report(
        report.verdict,
        {**report.summary, "label": label},
        report.quality,
        report.frames,
        report.cases,
        rows,
        report.timeline,
        report.defects,
    )


def test_hostile_texts_stay_texts(tmp_path: Path) -> None:
    hostile = "</script><script>alert(1)</script>\u2028"
    write_page(tmp_path, ViewerSource(report_with(hostile), None, None), None)
    script = (tmp_path / "data.js").read_text(encoding="ascii")
    assert "<" not in script
    assert document_of(tmp_path)["title"] == hostile
    assert {one["label"] for one in document_of(tmp_path)["detections"]} == {hostile}


def test_a_run_that_lost_its_surface_names_the_stage() -> None:
    report = build_report(failed_record())
    assert viewer_document(ViewerSource(report, None, None))["surface_reason"]
    lost = report_with("dent")
    partial = {**lost.summary, "failed_stage": "mesh", "message": "Poisson meshing left no surface"}
    source = ViewerSource(
        Report(lost.verdict, partial, lost.quality, lost.frames, (), lost.detections, lost.timeline, lost.defects),
        None,
        None,
    )
    shown = viewer_document(source)
    assert "mesh" in shown["surface_reason"]
    assert shown["row"] == {"status": "unknown", "reason": "not_computed"}


def test_blades_whose_coverage_is_told_bear_the_names_of_the_tables() -> None:
    seen = [{"blade": number, "share": 1.0, "views_2": 0.5} for number in (1, 2)]
    row = {"status": "estimated", "coverage": seen, "on_first": {"names": {"1": "4"}}}
    further = viewer_document(ViewerSource(report_with("dent"), None, None, model=1, models=(0, 1), row=row))
    assert [(one["blade"], one["name"]) for one in further["row"]["coverage"]] == [(1, "4"), (2, "1-B2")]
    assert "name" not in seen[0], "the object of row.json stays as it is"
    first = viewer_document(ViewerSource(report_with("dent"), None, None, row={"status": "user", "coverage": seen}))
    assert [one["name"] for one in first["row"]["coverage"]] == ["1", "2"]


def test_addresses_of_pages() -> None:
    assert [page_of(1, 0), page_of(0, 1), page_of(2, 1)] == [
        "../models/1/viewer/index.html",
        "../../../viewer/index.html",
        "../../../models/2/viewer/index.html",
    ]
