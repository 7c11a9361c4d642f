"""The whole method on the small sample, through the command as a user calls it (docs/outputs.md)."""

from __future__ import annotations

import csv
import hashlib
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bench.accuracy.score import score_result
from core.report.csv_form import read_csv
from core.surface.ply import read_mesh
from tests.core.making_videos import make_still_video
from tests.signals import heed_interrupts

pytestmark = pytest.mark.sample

ROOT = Path(__file__).parents[1]
VIDEO = ROOT / "samples" / "turbine.mp4"
ANNOTATIONS = ROOT / "samples" / "turbine.json"
TRUTH = ROOT / "samples" / "truth"
N_DETECTIONS = 90
N_FRAMES = 96

COLUMNS = {
    "frames.csv": "index source_index pts time_s sha256 role registered model",
    "cases.csv": "name kind start end status reason frames models registered_images points3D"
    " mean_reprojection_error_px median_reprojection_error_px seconds start_mode selected vetoed",
    "mapping/detections.csv": "id key time_s label score box_x1 box_y1 box_x2 box_y2 frame_index outcome reason rung"
    " support_points x y z confidence blade defect_id model",
    "mapping/timeline.csv": "event_id defect_id label start_s end_s n_detections n_frames x y z radius confidence",
}
OTHER_FILES = (
    "sparse/cameras.bin",
    "sparse/images.bin",
    "sparse/points3D.bin",
    "dense/fused.ply",
    "dense/mesh_poisson.ply",
    "dense/mesh_full.ply",
    "mapping/mesh_defects.ply",
    "mapping/mesh_defects.glb",
    "mapping/defect_points.ply",
    "gallery/index.html",
    "gallery/mesh_1.png",
    "gallery/mesh_2.png",
    "row.json",
    "row_map.svg",
)
JSON_TABLES = ("cases.json", "mapping/detections.json", "mapping/timeline.json", "mapping/defects.json")
# Timings of the run itself: the only thing that may differ between two runs of the same input.
CLOCK = {"seconds", "peak_rss_bytes"}


@dataclass(frozen=True)
class Ended:
    """A finished call of the command."""

    code: int
    events: list[dict[str, Any]]
    errors: str
    seconds: float

    @property
    def result(self) -> dict[str, Any]:
        return self.events[-1]

    def computed(self) -> set[str]:
        """Stages that were computed, not taken from an earlier run."""
        ended = [event for event in self.events if event["event"] == "ended"]
        return {event["stage"] for event in ended if not event["reused"] and event["state"] != "skipped"}


def start(out: Path, *more: str, video: Path = VIDEO, annotations: Path | None = ANNOTATIONS) -> subprocess.Popen[str]:
    words = [str(video), *([str(annotations)] if annotations else []), "--out", str(out), "--preset", "draft", "--json"]
    command = [sys.executable, "-m", "cli.main", "run", *words, *more]
    pipe = subprocess.PIPE
    return subprocess.Popen(
        command,
        cwd=ROOT,
        stdout=pipe,
        stderr=pipe,
        text=True,
        start_new_session=True,
        preexec_fn=heed_interrupts,
    )


def run(out: Path, *more: str, **inputs: Any) -> Ended:
    began = time.monotonic()
    output, errors = (process := start(out, *more, **inputs)).communicate(timeout=1800)
    events = [json.loads(line) for line in output.splitlines()]
    return Ended(process.returncode, events, errors, time.monotonic() - began)


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Ended]:
    out = tmp_path_factory.mktemp("sample") / "out"
    ended = run(out)
    assert ended.code == 0, ended.errors
    return out, ended


def fingerprint(out: Path) -> dict[str, str]:
    """Hash of every published file; clock times in tables are left out."""
    hashes = {}
    for path in sorted(p for p in out.rglob("*") if p.is_file() and ".bladeatlas" not in p.parts):
        data = path.read_bytes()
        if path.name in ("summary.json", "quality.json", "cases.json"):
            data = json.dumps(without_clock(json.loads(data))).encode()
        if path.name == "cases.csv":
            data = json.dumps([without_clock(row) for row in rows(path)]).encode()
        hashes[path.relative_to(out).as_posix()] = hashlib.sha256(data).hexdigest()
    return hashes


def without_clock(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: without_clock(inner) for name, inner in value.items() if name not in CLOCK}
    return [without_clock(inner) for inner in value] if isinstance(value, list) else value


def rows(path: Path) -> list[dict[str, str]]:
    return list(read_csv(path))


def read(path: Path) -> Any:
    def refuse(text: str) -> None:
        raise AssertionError(f"{path.name} holds {text}")

    return json.loads(path.read_text(encoding="utf-8"), parse_constant=refuse)


def test_all_files_of_the_contract(finished: tuple[Path, Ended]) -> None:
    out, ended = finished
    assert ended.result["event"] == "result"
    assert ended.result["state"] == "succeeded"
    for name, columns in COLUMNS.items():
        with (out / name).open(newline="", encoding="utf-8") as stream:
            header = next(csv.reader(stream))
        assert [column for column in header if column in columns.split()] == columns.split(), name
    for name in OTHER_FILES:
        assert (out / name).stat().st_size > 0, name
    for name in JSON_TABLES:
        assert isinstance(read(out / name), list), name
    for name in ("summary.json", "quality.json"):
        assert read(out / name)["schema_version"] == 1


def test_summary_and_quality(finished: tuple[Path, Ended]) -> None:
    out, _ = finished
    summary, quality = read(out / "summary.json"), read(out / "quality.json")
    assert summary["state"] == "succeeded"
    for name in ("parameters", "fingerprint", "versions", "stages"):
        assert summary[name], name
    assert set(summary["scale"]) == {"unit", "value", "sigma", "source"}
    for stage in summary["stages"]:
        assert {"name", "state", "seconds", "peak_rss_bytes"} <= set(stage)
        assert stage["peak_rss_bytes"] < 4 * 2**30
    assert quality["verdict"] in ("ok", "suspect")
    assert quality["funnel"]["detections"] == N_DETECTIONS
    assert quality["funnel"]["mapped"] == sum(
        row["outcome"] == "mapped" for row in read(out / "mapping/detections.json")
    )


def test_every_detection_has_one_row(finished: tuple[Path, Ended]) -> None:
    out, _ = finished
    table, records = rows(out / "mapping/detections.csv"), read(out / "mapping/detections.json")
    wanted = [
        (key, item["label"], item["bbox"])
        for key, entry in json.loads(ANNOTATIONS.read_text()).items()
        for item in entry.get("detections", [])
    ]
    assert len(table) == len(records) == len(wanted) == N_DETECTIONS
    for i, (row, record, (key, label, box)) in enumerate(zip(table, records, wanted, strict=True)):
        assert (row["id"], record["id"]) == (str(i), i)
        assert row["key"] == record["key"] == key
        assert record["label"] == label
        assert [record[f"box_{corner}"] for corner in ("x1", "y1", "x2", "y2")] == pytest.approx(box)
        assert record["outcome"] in ("mapped", "approximate", "unplaced")
        assert (record["outcome"] == "mapped") == (record["reason"] in (None, ""))
        assert (record["outcome"] == "unplaced") == (record["x"] is None)
        for name, value in record.items():
            assert row[name] == ("" if value is None else str(value)), name


def test_frames_are_numbered_by_time(finished: tuple[Path, Ended]) -> None:
    out, _ = finished
    table = rows(out / "frames.csv")
    assert [int(row["index"]) for row in table] == list(range(len(table)))
    assert len(table) <= N_FRAMES
    for row in table:
        assert float(row["time_s"]) == pytest.approx(int(row["source_index"]) / 12, abs=1e-6)
        assert len(row["sha256"]) == 64
    assert sum(row["registered"] == "1" for row in table) > 0.9 * len(table)
    cases = rows(out / "cases.csv")
    assert [row["selected"] for row in cases].count("1") == 1


def test_meshes_carry_support_and_defects(finished: tuple[Path, Ended]) -> None:
    out, _ = finished
    full, kept = read_mesh(out / "dense/mesh_full.ply"), read_mesh(out / "dense/mesh_poisson.ply")
    assert 0 < len(kept.faces) < len(full.faces)
    defects = read_mesh(out / "mapping/mesh_defects.ply")
    assert len(defects.vertices) == len(kept.vertices)
    for mesh in (full, kept, defects):
        support = np.asarray(mesh.extra["support"])
        assert support.min() >= 0
        assert support.max() <= 1
    ids = set(np.unique(defects.extra["defect_id"]).tolist())
    known = {record["id"] for record in read(out / "mapping/defects.json")}
    assert -1 in ids
    assert ids - {-1}
    assert ids - {-1} <= known
    assert defects.colors is not None


def test_accuracy_against_the_truth(finished: tuple[Path, Ended]) -> None:
    """Bounds leave room for other machines' rounding, not for a broken stage."""
    score = score_result(finished[0], TRUTH)
    assert score["frames"]["registered_share"] >= 0.9
    assert score["cameras"]["position_median_mm"] < 0.3
    assert score["cameras"]["rotation_median_deg"] < 1.0
    assert score["mesh"]["accuracy_median_mm"] < 0.4


def test_the_findings_lie_on_their_blades(finished: tuple[Path, Ended]) -> None:
    """The two defects of the clip lie on blades 0 and 2 of the scene, on their convex sides."""
    out, _ = finished
    row, records = read(out / "row.json"), read(out / "mapping/defects.json")
    assert row["status"] == "estimated"
    assert row["pitch_deg"] == pytest.approx(5.625, rel=0.06)
    assert row["count"][0] <= 64
    assert [record["side"] for record in records] == ["convex", "convex"]
    assert int(records[1]["blade"]) - int(records[0]["blade"]) == 2
    assert [record["span"] for record in records] == pytest.approx([0.523, 0.717], abs=0.05)
    rows_ = [one for one in read(out / "mapping/detections.json") if one["outcome"] == "mapped"]
    assert sum(one["blade"] is not None and one["side"] == "convex" for one in rows_) > 0.95 * len(rows_)
    assert {event["blade"] for event in read(out / "mapping/timeline.json")} == {one["blade"] for one in records}
    assert read_mesh(out / "mapping/mesh_defects.ply").extra["blade"].max() == len(row["blades"])


@pytest.mark.long  # a minute or more
def test_the_number_of_blades_costs_no_search(finished: tuple[Path, Ended], tmp_path: Path) -> None:
    out = tmp_path / "out"
    shutil.copytree(finished[0], out)
    ended = run(out, "--set", "row.count=64", "--set", "row.edge_a=leading")
    assert ended.code == 0, ended.errors
    assert ended.computed() == {"blades", "timeline", "gallery", "viewer"}
    row = read(out / "row.json")
    assert (row["status"], row["count"], row["pitch_deg"]) == ("user", [64, 64], 5.625)
    ids = [[one["id"] for one in read(folder / "mapping/defects.json")] for folder in (finished[0], out)]
    assert ids[0] == ids[1]


def test_running_again_is_instant_and_identical(finished: tuple[Path, Ended]) -> None:
    out, _ = finished
    before = fingerprint(out)
    again = run(out)
    assert again.code == 0, again.errors
    assert again.result["computed"] == 0
    assert again.computed() == set()
    assert again.seconds < 30
    assert fingerprint(out) == before


@pytest.mark.long  # a minute or more
def test_changed_mapping_computes_mapping_only(finished: tuple[Path, Ended], tmp_path: Path) -> None:
    out = tmp_path / "out"
    shutil.copytree(finished[0], out)
    ended = run(out, "--set", "mapping.radius_fraction=0.02")
    assert ended.code == 0, ended.errors
    assert ended.computed() == {"map_defects", "timeline", "gallery", "viewer"}
    before, after = fingerprint(finished[0]), fingerprint(out)
    changed = {name for name in before if before[name] != after.get(name)}
    assert "mapping/mesh_defects.ply" in changed
    assert not {name for name in changed if name.startswith(("sparse/", "dense/"))}


def test_another_input_is_refused(finished: tuple[Path, Ended]) -> None:
    before = fingerprint(finished[0])
    ended = run(finished[0], annotations=None)
    assert ended.code == 2
    assert "another input" in ended.errors
    assert ended.errors.count("\n") == 1
    assert fingerprint(finished[0]) == before


@pytest.mark.long  # a minute or more
def test_a_static_camera_ends_without_reconstruction(tmp_path: Path) -> None:
    """An outcome, not bad input: exit 3, the flag that says why, and a row for every detection."""
    video = make_still_video(tmp_path / "still.mp4", VIDEO, 24)
    detection = {"detections": [{"label": "nick", "score": 0.9, "bbox": [0.4, 0.4, 0.5, 0.5]}]}
    annotations = tmp_path / "still.json"
    annotations.write_text(json.dumps({"0.5": detection, "1.0": detection}))
    out = tmp_path / "out"
    ended = run(out, video=video, annotations=annotations)
    assert ended.code == 3
    summary, quality = read(out / "summary.json"), read(out / "quality.json")
    assert (summary["state"], summary["reason"]) == ("failed", "no_reconstruction")
    assert quality["verdict"] == "refused"
    assert "no_parallax" in {flag["code"] for flag in quality["flags"]}
    detections = rows(out / "mapping" / "detections.csv")
    assert [row["outcome"] for row in detections] == ["unplaced", "unplaced"]
    assert not (out / "mapping" / "mesh_defects.ply").exists()
    assert ended.errors.count("\n") == 1


def lines_until(process: subprocess.Popen[str], **wanted: str) -> Iterator[dict[str, Any]]:
    """Events up to and with the first that has the wanted values."""
    assert process.stdout is not None
    for line in process.stdout:
        event = json.loads(line)
        yield event
        if all(event.get(name) == value for name, value in wanted.items()):
            return
    raise AssertionError(f"the run ended before {wanted}: {process.stderr.read() if process.stderr else ''}")


@pytest.mark.long
def test_interrupted_and_killed_runs_go_on_to_the_same_result(finished: tuple[Path, Ended], tmp_path: Path) -> None:
    out = tmp_path / "out"
    process = start(out)
    list(lines_until(process, event="ended", key="frames"))
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 130
    assert "the same command goes on" in errors

    process = start(out)
    list(lines_until(process, event="started", stage="matches"))
    time.sleep(1.0)
    os.kill(process.pid, signal.SIGKILL)
    process.communicate(timeout=60)
    assert not (out / "summary.json").exists()

    process = start(out)
    events = list(lines_until(process, event="started", stage="depth"))
    assert {event["stage"] for event in events if event["event"] == "ended" and event["reused"]} >= {
        "probe",
        "features",
    }
    time.sleep(1.0)
    os.kill(process.pid, signal.SIGKILL)
    process.communicate(timeout=60)

    ended = run(out)
    assert ended.code == 0, ended.errors
    assert not {"probe", "features", "matches", "undistort"} & ended.computed()
    assert fingerprint(out) == fingerprint(finished[0])
