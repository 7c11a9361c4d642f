from __future__ import annotations

import pytest

from core.scene.detection import DETECTION_COLUMNS, REASONS, Reason, outcome_counts, rows_without_model, unplaced_row
from core.scene.frame import SourceFrame
from tests.core.making_rows import detection, mapped, unplaced

CONTRACT = (
    "id key time_s label score box_x1 box_y1 box_x2 box_y2 frame_index outcome reason rung support_points "
    "x y z confidence blade defect_id model video "
    "length length_sigma width width_sigma area area_sigma length_unit size_from "
    "side span span_sigma chord chord_sigma edge_distance edge_distance_sigma root_distance root_distance_sigma"
)


def test_columns_are_the_contract() -> None:
    assert " ".join(DETECTION_COLUMNS) == CONTRACT
    assert tuple(mapped(0, (1, 2, 3)).to_dict()) == DETECTION_COLUMNS


def test_an_unknown_reason_is_refused() -> None:
    with pytest.raises(ValueError, match="bad luck"):
        unplaced_row(detection(), Reason("bad luck"))


def test_all_reasons_of_the_contract_are_known() -> None:
    expected = (
        "no_frame no_registered_view frame_not_registered outside_roi no_support off_surface occluded contradicted"
    )
    assert list(REASONS) == expected.split()


def test_without_a_model_no_detection_is_dropped() -> None:
    asked = [detection(0, source_index=None), detection(1, source_index=4), detection(2, source_index=5)]
    rows = rows_without_model(asked, {SourceFrame(0, 5): 1})
    assert [row.reason for row in rows] == ["no_frame", "no_registered_view", "frame_not_registered"]
    assert [row.frame_index for row in rows] == [None, None, 1]


def test_counts() -> None:
    counts = outcome_counts([mapped(0, (0, 0, 0)), unplaced(1), unplaced(2, "no_frame")])
    assert counts == {"outcomes": {"mapped": 1, "unplaced": 2}, "reasons": {"no_frame": 1, "no_support": 1}}
