from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from core.scene.defect import TIMELINE_COLUMNS, Sighting
from core.scene.detection import leading_label
from core.thesis.grouping import cluster_detections, defect_records, event_rows, extent_of, with_defect_ids
from tests.core.making_rows import mapped, unplaced

ROWS = [
    mapped(0, (0, 0, 0), 1.0, "dent", frame=3),
    mapped(1, (0.2, 0, 0), 1.0, "nick", frame=3),
    mapped(2, (0.1, 0, 0), 4.0, "nick", frame=7),
    unplaced(3),
    mapped(4, (5, 5, 5), 2.0, "burn", frame=4),
]
CLUSTERS = cluster_detections(ROWS, 1.0)


def test_columns_are_the_contract() -> None:
    expected = "event_id defect_id label start_s end_s n_detections n_frames x y z radius confidence video blade"
    assert " ".join(TIMELINE_COLUMNS) == expected


def test_one_event_per_cluster() -> None:
    first, second = event_rows(CLUSTERS)
    assert (first.event_id, first.label, first.start_s, first.end_s) == (0, "nick", 1.0, 4.0)
    assert (first.n_detections, first.n_frames) == (3, 2)
    assert (first.x, first.y, first.z) == pytest.approx((0.1, 0, 0))
    assert (second.event_id, second.defect_id, second.label) == (1, 1, "burn")


def test_a_cluster_of_two_videos_is_one_defect_with_an_event_in_each() -> None:
    rows = [replace(row, video=int(row.time_s > 1.5)) for row in ROWS]
    clusters = cluster_detections(rows, 1.0)
    events = event_rows(clusters)
    assert [(event.video, event.defect_id, event.start_s) for event in events] == [
        (0, 0, 1.0),
        (1, 1, 2.0),
        (1, 0, 4.0),
    ]
    assert [event.event_id for event in events] == [0, 1, 2]
    supports = {row.id: np.zeros((1, 3)) for row in rows}
    records = defect_records(clusters, events, supports, [[], []], [[], []])
    assert [record.events for record in records] == [(0, 2), (1,)]


def test_rows_get_their_defect_and_keep_their_order() -> None:
    rows = with_defect_ids(ROWS, CLUSTERS)
    assert [row.id for row in rows] == [0, 1, 2, 3, 4]
    assert [row.defect_id for row in rows] == [0, 0, 0, None, 1]


def test_label_by_count_then_score_then_alphabet() -> None:
    assert leading_label([mapped(0, (0, 0, 0), label="b"), mapped(1, (0, 0, 0), label="a", score=0.1)]) == "b"
    assert leading_label([mapped(0, (0, 0, 0), label="b"), mapped(1, (0, 0, 0), label="a")]) == "a"


def test_extent_of_an_even_disc_is_its_diameter() -> None:
    rng = np.random.default_rng(0)
    radius, angle = np.sqrt(rng.uniform(size=20_000)), rng.uniform(0, 2 * np.pi, 20_000)
    disc = np.stack([radius * np.cos(angle), radius * np.sin(angle), np.zeros(20_000)], axis=1)
    extent = extent_of([disc])
    assert extent.value == pytest.approx(2.0, rel=0.02)
    assert (extent.unit, extent.sigma) == ("model", None)


def test_extent_ignores_a_few_points_far_behind() -> None:
    square = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0], [0.5, 0.5, 0], [0.5, 0.4, 0]], float)
    with_far = np.vstack([square, [[0.5, 0.5, 40.0]]])
    assert (extent_of([with_far]).value or 9) < 3
    assert extent_of([square, square, 1.2 * square]).sigma is not None


def test_defect_records() -> None:
    supports = {row.id: np.array([[0.0, 0, 0], [1, 0, 0]]) for row in ROWS}
    seen = [[Sighting(7, 1.0), Sighting(3, 0.5), Sighting(5, 0.25)], []]
    first, second = (
        one.to_dict() for one in defect_records(CLUSTERS, event_rows(CLUSTERS), supports, seen, [[4, 5], []])
    )
    assert first["persistence"] == {"k": 2, "n": 3, "share": pytest.approx(2 / 3)}
    assert first["frames"][0] == {"frame_index": 7, "quality": 1.0, "detected": True}
    assert first["frames"][2]["detected"] is False
    assert (first["detections"], first["events"], first["faces"]) == ([0, 1, 2], [0], [4, 5])
    assert (first["confidence"], first["blade"]) == (None, None)
    assert first["labels"] == {"dent": 1, "nick": 2}
    assert second["persistence"] == {"k": 1, "n": 1, "share": 1.0}
