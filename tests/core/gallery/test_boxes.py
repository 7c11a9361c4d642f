from __future__ import annotations

from dataclasses import replace

import numpy as np

from core.gallery.boxes import (
    FrameBoxes,
    choose_frames,
    draw_boxes,
    draw_defect_numbers,
    draw_place,
    group_by_frame,
)
from core.gallery.palette import PALETTE, label_colors
from core.scene.frame import SourceFrame
from tests.core.making_rows import mapped, unplaced

BLACK = np.zeros((200, 300, 3), np.uint8)


def test_frames_are_those_with_detections_in_order() -> None:
    rows = [mapped(0, (0, 0, 0)), mapped(1, (0, 0, 0)), unplaced(2, "no_frame"), mapped(3, (0, 0, 0))]
    frames = group_by_frame(rows, {0: SourceFrame(0, 9), 1: SourceFrame(0, 4), 2: None, 3: SourceFrame(0, 9)})
    assert [(frame.source.source_index, [row.id for row in frame.rows]) for frame in frames] == [(4, [1]), (9, [0, 3])]
    assert frames[0].file_name == "frame_000004.jpg"


def test_a_place_without_a_box_gets_a_cross() -> None:
    marked = draw_place(BLACK, 3, (0.5, 0.25)).astype(int)
    rows, columns = np.nonzero(marked[..., 0] > 200)
    assert (marked[50, 150] > 0).any()
    assert (abs(rows - 50).max(), abs(columns - 150).max()) < (40, 60), "the cross and its number, nothing elsewhere"
    assert not BLACK.any(), "the frame itself stays as it is"
    for corner in ((0.0, 0.0), (1.0, 1.0)):
        assert draw_place(BLACK, 3, corner).any()


def test_too_many_frames_keep_the_best_of_every_defect_and_label() -> None:
    def frame(number: int, score: float, label: str, defect: int | None) -> FrameBoxes:
        row = mapped(number, (0, 0, 0), label=label, score=score)
        return FrameBoxes(SourceFrame(0, number), 0.0, (replace(row, defect_id=defect),))

    frames = [
        frame(0, 0.9, "dent", 0),
        frame(1, 0.8, "dent", 0),
        frame(2, 0.1, "dent", 1),
        frame(3, 0.2, "rare", None),
        frame(4, 0.95, "dent", None),
        frame(5, 0.3, "dent", None),
    ]
    assert [f.source.source_index for f in choose_frames(frames, 4)] == [0, 2, 3, 4]
    assert [f.source.source_index for f in choose_frames(frames, 5)] == [0, 1, 2, 3, 4]
    assert choose_frames(frames, 6) == frames


def test_mapped_boxes_are_solid_others_dashed() -> None:
    row = mapped(0, (0, 0, 0))  # box 0.4 .. 0.6
    colors = label_colors(["dent"])
    solid = draw_boxes(BLACK, [row], colors)
    dashed = draw_boxes(BLACK, [unplaced(0)], colors)
    edge = np.s_[120, 121:179]  # lower edge of the box
    assert (solid[edge] == PALETTE[0]).all(axis=1).all()
    hits = (dashed[edge] == PALETTE[0]).all(axis=1)
    assert 0.3 < hits.mean() < 0.8
    assert not BLACK.any(), "the frame itself stays as it is"


def test_any_label_can_be_drawn() -> None:
    rows = [mapped(0, (0, 0, 0), label="☃" * 500), mapped(1, (0, 0, 0), label="", score=None)]
    assert draw_boxes(BLACK, rows, label_colors([row.label for row in rows])).shape == BLACK.shape


def test_colours_depend_on_the_labels_alone() -> None:
    assert label_colors(["b", "a", "b"]) == {"a": PALETTE[0], "b": PALETTE[1]}


def test_numbers_mark_every_visible_defect_apart() -> None:
    defect = np.full((600, 800), -1, np.int32)
    defect[300:310, 400:410] = 0
    defect[300:310, 412:420] = 1
    one = draw_defect_numbers(np.zeros((600, 800, 3), np.uint8), np.where(defect == 0, 0, -1).astype(np.int32))
    two = draw_defect_numbers(np.zeros((600, 800, 3), np.uint8), defect)
    white = [(picture == 255).all(axis=2).sum() for picture in (one, two)]
    assert white[1] > 1.6 * white[0] > 0
