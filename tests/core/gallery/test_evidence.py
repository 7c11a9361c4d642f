"""The picture that shows why a defect is there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from core.gallery.evidence import HEIGHT_PX, draw_evidence, evidence_of
from core.gallery.page import gallery_page
from core.scene.defect import Confidence, Persistence, Sighting
from tests.core.making_rows import defect, mapped

ROW = replace(mapped(0, (1, 2, 3), frame=7), defect_id=0, box_x1=0.45, box_y1=0.45, box_x2=0.55, box_y2=0.55)
RECORD = defect(
    0,
    "dent <1>",
    confidence=Confidence(0.914, {}),
    persistence=Persistence(3, 5),
    frames=(
        Sighting(4, 1.0, (0.1, 0.1)),
        Sighting(7, 0.9, (0.52, 0.5), detected=True),
        Sighting(8, 0.8, (0.6, 0.5), detected=True),
    ),
)


def test_the_best_frame_that_detected_it_is_shown() -> None:
    (one,) = evidence_of([RECORD], [ROW, replace(ROW, frame_index=8)])
    assert (one.frame_index, one.file_name, one.place) == (7, "defect_000.jpg", (0.52, 0.5))
    assert one.boxes == ((0.45, 0.45, 0.55, 0.55),)
    assert one.caption == "D0 dent <1>, confidence 0.91, in 3 of 5 frames that could show it"
    unseen = replace(RECORD, frames=RECORD.frames[:1])
    assert evidence_of([unseen], [ROW]) == []


@pytest.mark.parametrize("size", [(240, 320), (720, 960), (480, 270)])
def test_frame_and_close_up_side_by_side(size: tuple[int, int]) -> None:
    height, width = size
    rgb = np.full((height, width, 3), 90, np.uint8)
    middle = (slice(int(0.47 * height), int(0.53 * height)), slice(int(0.47 * width), int(0.53 * width)))
    rgb[middle] = (20, 200, 20)
    (one,) = evidence_of([RECORD], [ROW])
    picture = draw_evidence(rgb, one)
    shown = round(width * HEIGHT_PX / height)
    assert picture.shape[1] == shown + 4 + HEIGHT_PX
    green = (picture[:HEIGHT_PX, :, 1] > 150) & (picture[:HEIGHT_PX, :, 0] < 80)
    assert green[:, shown + 4 :].sum() > 3 * green[:, :shown].sum(), "the close-up shows it larger"
    red = (picture[:HEIGHT_PX, :, 0] > 220) & (picture[:HEIGHT_PX, :, 1] < 90)
    columns = np.nonzero(red[:, :shown].any(axis=0))[0]
    assert columns.mean() == pytest.approx(0.52 * shown, abs=3)


def test_a_box_at_the_rim_has_its_close_up_inside_the_frame() -> None:
    (one,) = evidence_of([RECORD], [replace(ROW, box_x1=0.95, box_x2=1.05, box_y1=-0.02, box_y2=0.05)])
    assert draw_evidence(np.zeros((120, 160, 3), np.uint8), one).shape[0] > HEIGHT_PX


def test_the_page_shows_it_and_escapes_its_label() -> None:
    found = evidence_of([RECORD], [ROW])
    page = gallery_page([], 0, [ROW], [], {"dent": (1, 2, 3)}, found)
    assert 'src="defect_000.jpg"' in page
    assert "dent &lt;1&gt;" in page
    assert '<h2 id="v">Evidence' not in gallery_page([], 0, [ROW], [], {"dent": (1, 2, 3)})
