"""The table of defects: sizes, their order, and the frame that shows each best."""

from __future__ import annotations

from typing import Any

import pytest

from core.gallery.defects import BestFrame, Instant, defect_lines
from core.scene.defect import DefectRecord, EventRow, Extent, Persistence, Sighting
from core.scene.frame import SourceFrame
from tests.core.making_rows import defect, run_frames

FRAMES = run_frames(8, 0.5, every=10)
VIEWS = (Sighting(7, 1.0, (0.25, 0.5)), Sighting(4, 0.9, (0.5, 0.5), detected=True))


def record(number: int, extent: Extent | None, **more: Any) -> DefectRecord:
    values = {"detections": (0, 1, 2, 3), "frames": VIEWS, "persistence": Persistence(3, 5)}
    return defect(number, extent=extent, **{**values, **more})


def size(value: float | None, sigma: float | None = 0.01, unit: str = "model") -> Extent:
    return Extent(value, unit, sigma)


def visit(defect_id: int, start_s: float, end_s: float) -> EventRow:
    return EventRow(0, defect_id, "dent", start_s, end_s, 1, 1, 0.0, 0.0, 0.0, 0.0, None)


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
def test_a_size_has_its_sigma_and_unit(extent: Extent | None, text: str) -> None:
    (line,) = defect_lines([record(0, extent)], [], FRAMES)
    assert line.size_text == text


def test_a_row_spans_all_visits_of_its_defect() -> None:
    events = [visit(1, 5.0, 6.0), visit(0, 0.0, 9.0), visit(1, 1.0, 2.0)]
    (line,) = defect_lines([record(1, None)], events, FRAMES)
    assert (line.start, line.end, line.visits) == (Instant(0, 1.0), Instant(0, 6.0), 2)
    assert (line.n_detections, line.n_frames, line.n_could_show) == (4, 3, 5)


def test_the_best_frame_is_the_first_of_the_record() -> None:
    (line,) = defect_lines([record(0, None)], [], FRAMES)
    assert line.best == BestFrame(SourceFrame(0, 70), 3.5, (0.25, 0.5))
    by_thesis = (Sighting(4, 1.0, detected=True),)
    assert defect_lines([record(0, None, frames=by_thesis)], [], FRAMES)[0].best == BestFrame(
        SourceFrame(0, 40), 2.0, None
    )
    assert defect_lines([record(0, None, frames=())], [], FRAMES)[0].best is None
