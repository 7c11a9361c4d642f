from __future__ import annotations

import json
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import ArrayLike
from scipy.spatial.transform import Rotation

from bench.accuracy import surface
from bench.accuracy.confidence import auroc, calibration_error
from bench.accuracy.placement import true_defect
from bench.accuracy.score import score_result
from bench.accuracy.truth import TrueBox
from bench.main import main
from core.errors import BadInput
from core.geometry.boxes import box_iou
from tests.bench import synthetic

Writer = Callable[..., Path]

CENTERS = [np.array(row["surface_center"]) for row in synthetic.defects()[:2]]


@pytest.fixture(scope="session")
def truth_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return synthetic.write_truth(tmp_path_factory.mktemp("truth"))


@pytest.fixture(autouse=True)
def fewer_samples(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(surface, "N_SAMPLES", 20_000)


@pytest.fixture
def write_result(tmp_path: Path) -> Writer:
    return partial(synthetic.write_result, tmp_path)


def record(number: int, place_m: ArrayLike, **more: object) -> dict[str, object]:
    return {"id": number, "centroid": synthetic.to_model(np.asarray(place_m)).tolist(), **more}


def test_a_perfect_result_scores_perfectly(truth_folder: Path, write_result: Writer) -> None:
    rows = [synthetic.detection(f, synthetic.BOXES[d], CENTERS[d]) for f in range(4) for d in (0, 1)]
    folder = write_result(detections=rows, defects=[record(d, CENTERS[d]) for d in (0, 1)])
    score = score_result(folder, truth_folder)
    assert score["frames"] == {
        "source_frames": 10,
        "registered": 10,
        "registered_share": 1.0,
        "annotated": 4,
        "registered_annotated_share": 1.0,
    }
    assert score["cameras"]["position_p95_mm"] < 1e-6
    assert score["cameras"]["rotation_p95_deg"] < 1e-6
    assert score["cameras"]["scale_mm_per_su"] == pytest.approx(synthetic.SCALE * 1000)
    assert score["mesh"]["accuracy_p95_mm"] < 1e-3
    assert score["mesh"]["0.25%"]["f1"] == 1.0
    assert score["cloud"]["accuracy_median_mm"] < 1e-3
    assert score["placement"]["mapped_share"] == 1.0
    assert score["placement"]["wrong_mapped_share"] == 0.0
    assert score["placement"]["position_median_mm"] < 1e-3
    assert score["defects"] == {"expected": 2, "records": 2, "found": 2, "split": 0, "extra": 0, "exact": True}


def test_shares_are_of_all_source_frames_not_of_those_chosen(truth_folder: Path, write_result: Writer) -> None:
    rows = [synthetic.detection(f, synthetic.BOXES[0], None, outcome="unplaced") for f in (0, 7, 8, 9)]
    frames = score_result(write_result(frames=[0, 2, 4, 6, 8], detections=rows), truth_folder)["frames"]
    assert frames["registered_share"] == 0.5
    assert frames["registered_annotated_share"] == 0.5


def test_one_turned_camera_has_its_rotation_error_and_no_other(truth_folder: Path, write_result: Writer) -> None:
    poses = synthetic.camera_poses()
    poses[:, :3, :3] = poses[:, :3, :3] @ Rotation.from_euler("z", 2, degrees=True).as_matrix()
    cameras = score_result(write_result(poses=poses), truth_folder)["cameras"]
    assert cameras["rotation_median_deg"] == pytest.approx(2.0, abs=1e-6)
    assert cameras["position_p95_mm"] < 1e-6


def test_a_displaced_surface_is_measured_in_mm_and_falls_out_of_the_tolerances(
    truth_folder: Path, write_result: Writer
) -> None:
    vertices, _ = synthetic.plate()
    score = score_result(write_result(points=vertices + np.array([0, 0, 0.0002])), truth_folder)
    assert score["mesh"]["accuracy_median_mm"] == pytest.approx(0.19, abs=0.015)
    assert score["mesh"]["1%"]["f1"] == 1.0
    assert score["mesh"]["0.25%"]["precision"] < 0.1
    assert score["mesh"]["1%"]["tau_mm"] == pytest.approx(0.27)


def test_a_surface_that_covers_half_has_half_the_recall(truth_folder: Path, write_result: Writer) -> None:
    vertices, _ = synthetic.plate()
    mirrored = vertices.reshape(31, 31, 3)[:, ::-1].reshape(-1, 3)
    folded = np.where(vertices[:, :1] < 0, vertices, mirrored)
    scores = score_result(write_result(points=folded), truth_folder)["mesh"]["0.5%"]
    assert scores["precision"] == 1.0
    assert scores["recall"] == pytest.approx(0.5, abs=0.05)


def test_wrong_places_and_false_boxes_are_told_apart(truth_folder: Path, write_result: Writer) -> None:
    far = CENTERS[0] + [0.012, 0, 0]
    rows = [
        synthetic.detection(0, synthetic.BOXES[0], CENTERS[0] + [0.0005, 0, 0], confidence=0.9),
        synthetic.detection(1, synthetic.BOXES[0], far, confidence=0.6),
        synthetic.detection(2, synthetic.BOXES[1], CENTERS[1], outcome="approximate", rung="sparse"),
        synthetic.detection(3, synthetic.BOXES[1], None, outcome="unplaced", rung=None),
        synthetic.detection(4, [10, 10, 60, 60], far, confidence=0.8, defect_id=3),
        synthetic.detection(5, [10, 10, 60, 60], None, outcome="unplaced"),
    ]
    records = [record(3, far, persistence={"k": 6, "n": 8})]
    score = score_result(write_result(detections=rows, defects=records), truth_folder)
    placement = score["placement"]
    assert (placement["placeable"], placement["mapped_share"], placement["wrong_mapped_share"]) == (4, 0.5, 0.5)
    assert placement["by_rung"]["sparse"]["placed"] == 1
    assert placement["by_rung"]["surface"]["position_p95_mm"] == pytest.approx(12 - 0.05 * 11.5, abs=0.01)
    assert placement["false_boxes"] == {
        "count": 2,
        "mapped_share": 0.5,
        "mapped_confident_share": 0.5,
        "mapped_confident_persistent_share": 0.5,
    }
    assert score["defects"]["extra"] == 1
    assert score["defects"]["found"] == 0
    assert score["confidence"]["auroc"] == 1.0


def test_split_and_missed_defects_are_counted(truth_folder: Path, write_result: Writer) -> None:
    rows = [synthetic.detection(0, synthetic.BOXES[d], CENTERS[d]) for d in (0, 1)]
    records = [record(0, CENTERS[0]), record(1, CENTERS[0] + [0.002, 0, 0])]
    counts = score_result(write_result(detections=rows, defects=records), truth_folder)["defects"]
    assert counts == {"expected": 2, "records": 2, "found": 1, "split": 1, "extra": 0, "exact": False}


def test_nothing_reconstructed_is_a_score_not_a_crash(truth_folder: Path, tmp_path: Path) -> None:
    (tmp_path / "frames.csv").write_text("index,source_index\n0,0\n")
    score = score_result(tmp_path, truth_folder)
    assert score["frames"]["registered_share"] == 0.0
    assert score["cameras"] is None
    assert score["mesh"] is None


def test_further_models_are_aligned_and_reported_apart(truth_folder: Path, write_result: Writer) -> None:
    folder = write_result(frames=range(5))
    second = folder / "models/1/sparse"
    second.mkdir(parents=True)
    synthetic.sparse_model(synthetic.camera_poses()[:4] * 1.0).write_binary(second)
    score = score_result(folder, truth_folder)
    assert score["frames"]["registered"] == 5
    assert score["models"]["1"]["frames"]["registered"] == 4
    assert score["models"]["1"]["cameras"]["position_p95_mm"] < 1e-6


@pytest.mark.parametrize(
    ("other", "expected"),
    [
        ([0, 0, 10, 10], 1.0),
        ([5, 0, 15, 10], 1 / 3),
        ([10, 0, 20, 10], 0.0),
        ([20, 20, 30, 30], 0.0),
        ([2, 2, 8, 8], 0.36),
    ],
)
def test_box_overlap(other: list[float], expected: float) -> None:
    assert box_iou(np.array([0.0, 0, 10, 10]), np.array(other, float)) == pytest.approx(expected)


def test_the_true_defect_is_the_largest_overlap_of_at_least_a_fifth() -> None:
    visible = [TrueBox(4, np.array([0.0, 0, 10, 10])), TrueBox(7, np.array([2.0, 0, 12, 10]))]
    assert true_defect(np.array([3.0, 0, 13, 10]), visible) == 7
    assert true_defect(np.array([0.0, 0, 4, 4]), visible) is None
    assert true_defect(np.array([0.0, 0, 4, 4]), []) is None


def test_calibration_and_ranking_of_confidences() -> None:
    confidence, right = np.array([0.95, 0.95, 0.15, 0.15]), np.array([True, True, False, False])
    assert calibration_error(confidence, right) == pytest.approx(0.1)
    assert auroc(confidence, right) == 1.0
    assert auroc(confidence, ~right) == 0.0
    assert auroc(np.full(4, 0.5), right) == 0.5
    assert auroc(confidence, np.ones(4, bool)) is None


def test_the_command_prints_a_table_or_json(
    truth_folder: Path, write_result: Writer, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = write_result()
    assert main(["accuracy", str(folder), str(truth_folder)]) == 0
    assert "registered_share" in capsys.readouterr().out
    assert main(["accuracy", "--json", str(folder), str(truth_folder)]) == 0
    assert json.loads(capsys.readouterr().out)["frames"]["registered"] == 10


def test_a_folder_that_is_no_result_is_bad_input(
    truth_folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["accuracy", str(tmp_path), str(truth_folder)]) == 2
    assert "frames.csv" in capsys.readouterr().err
    with pytest.raises(BadInput):
        score_result(tmp_path, tmp_path)
