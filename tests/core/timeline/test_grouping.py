"""Ids of a further model go on where those of the models before it ended, in rows, events, records and colours."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from core.scene.defect import EventRow
from core.timeline.grouping import Start
from tests.core.making_rows import defect, mapped, unplaced

FACTS = {
    "timeline": {"n_defects": 3, "n_events": 5},
    "timeline@1": {"n_defects": 2, "n_events": 7},
    "timeline@2": {"n_defects": 11, "n_events": 13},
    "map_defects": {"n_defects": 100, "n_events": 100},
}


def test_ids_start_behind_those_of_all_models_before() -> None:
    assert Start.after(FACTS, 0) == Start(0, 0)
    assert Start.after(FACTS, 1) == Start(3, 5)
    assert Start.after(FACTS, 2) == Start(5, 12)


def test_every_file_counts_on_from_there() -> None:
    start = Start(3, 5)
    rows = [
        replace(mapped(0, (0, 0, 0), 1.0), defect_id=0),
        replace(mapped(1, (0, 0, 0), 1.0), defect_id=2),
        unplaced(2),
    ]
    assert [row.defect_id for row in start.rows(rows)] == [3, 5, None]
    event = EventRow(1, 0, "dent", 0.0, 1.0, 2, 2, 0.0, 0.0, 0.0, 1.0, None)
    assert start.events([event]) == [replace(event, event_id=6, defect_id=3)]
    record = defect(1, events=(0, 2), evidence="gallery/defect_001.jpg")
    assert start.records([record]) == [replace(record, id=4, events=(5, 7), evidence="gallery/defect_004.jpg")]
    assert start.vertices(np.array([-1, 0, 1], np.int32)).tolist() == [-1, 3, 4]
