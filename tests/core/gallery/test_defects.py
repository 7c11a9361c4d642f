"""The table of defects: sizes, their order, and the frame that shows each best."""

from __future__ import annotations

from typing import Any

import pytest

from core.gallery.defects import BestFrame, defect_lines

FRAMES = {4: {"source_index": 40, "time_s": 2.0}, 7: {"source_index": 70, "time_s": 3.5}}
VIEWS = [
    {"frame_index": 7, "quality": 1.0, "detected": False, "x": 0.25, "y": 0.5},
    {"frame_index": 4, "quality": 0.9, "detected": True, "x": 0.5, "y": 0.5},
]


def record(number: int, extent: dict[str, Any] | None, **more: Any) -> dict[str, Any]:
    seen = {"k": 3, "n": 5, "share": 0.6}
    values = {"label": "dent", "centroid": [1, 2, 3], "detections": [0, 1, 2, 3], "frames": VIEWS, "persistence": seen}
    return {"id": number, "extent": extent, **values, **more}


def size(value: float | None, sigma: float | None = 0.01, unit: str = "model") -> dict[str, Any]:
    return {"value": value, "unit": unit, "sigma": sigma}


def test_the_largest_comes_first_unknown_sizes_last_and_equal_ones_by_number() -> None:
    extents = [size(0.2), None, size(0.5), size(0.2), size(None), size(0.0)]
    lines = defect_lines([record(k, extent) for k, extent in reversed(list(enumerate(extents)))], [], FRAMES)
    assert [line.number for line in lines] == [2, 0, 3, 5, 1, 4]


@pytest.mark.parametrize(
    ("extent", "text"),
    [
        (size(0.12345, 0.0123), "0.123 ± 0.012 model units"),
        (size(3.21, 0.4, "mm"), "3.21 ± 0.4 mm"),
        (size(0.5, None), "0.5 ± unknown model units"),
        (None, "unknown"),
        (size(None), "unknown"),
    ],
)
def test_a_size_has_its_sigma_and_unit(extent: dict[str, Any] | None, text: str) -> None:
    (line,) = defect_lines([record(0, extent)], [], FRAMES)
    assert line.size_text == text


def test_a_row_spans_all_visits_of_its_defect() -> None:
    events = [
        {"defect_id": 1, "start_s": 5.0, "end_s": 6.0},
        {"defect_id": 0, "start_s": 0.0, "end_s": 9.0},
        {"defect_id": 1, "start_s": 1.0, "end_s": 2.0},
    ]
    (line,) = defect_lines([record(1, None)], events, FRAMES)
    assert (line.start_s, line.end_s, line.visits) == (1.0, 6.0, 2)
    assert (line.n_detections, line.n_frames, line.n_could_show) == (4, 3, 5)


def test_the_best_frame_is_the_first_of_the_record() -> None:
    (line,) = defect_lines([record(0, None)], [], FRAMES)
    assert line.best == BestFrame(70, 3.5, (0.25, 0.5))
    by_thesis = [{"frame_index": 4, "quality": 1.0, "detected": True}]
    assert defect_lines([record(0, None, frames=by_thesis)], [], FRAMES)[0].best == BestFrame(40, 2.0, None)
    assert defect_lines([record(0, None, frames=[])], [], FRAMES)[0].best is None
