"""Ids of a further model go on where those of the models before it ended, in rows, events, records and colours."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from core.mapping.observations import Observation
from core.products.contract import Products
from core.scene.defect import EventRow
from core.settings import make_settings
from core.surface.ply import Mesh
from core.timeline.defects import Defect, Found
from core.timeline.grouping import Start, paint_defects
from tests.core.making_rows import defect, mapped, unplaced

DONE = Products(
    {
        "timeline": {"n_defects": 3, "n_events": 5},
        "timeline@1": {"n_defects": 2, "n_events": 7},
        "timeline@2": {"n_defects": 11, "n_events": 13},
        "map_defects": {"n_defects": 100, "n_events": 100},
    }
)


def test_ids_start_behind_those_of_all_models_before() -> None:
    assert Start.after(DONE, 0) == Start(0, 0)
    assert Start.after(DONE, 1) == Start(3, 5)
    assert Start.after(DONE, 2) == Start(5, 12)


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


def test_a_vertex_is_painted_with_the_defect_whose_point_is_nearest() -> None:
    """Ten vertices in a row; of the detections in input order the second and the last belong to defects."""
    vertices = np.column_stack([np.arange(10.0), np.zeros(10), np.zeros(10)])
    faces = np.array([[k, k + 1, k + 2] for k in range(8)], np.int32)
    nothing = np.zeros(0)
    at = [[5.0], [1.0, 2.0], [4.0], [8.0]]
    observations = [
        Observation(
            mapped(k, (xs[0], 0, 0)),
            np.column_stack([xs, np.zeros((len(xs), 2))]),
            np.zeros(3),
            1.0,
            None,
            None,
            nothing.astype(np.int64),
            nothing.reshape(-1, 3),
        )
        for k, xs in enumerate(at)
    ]
    defects = [Defect((k,), nothing, 0.1, nothing, (), 1, 1, 1.0, ()) for k in (3, 1)]
    settings = make_settings(options={"mapping.radius_fraction": 0.05}).mapping
    weight, painted = paint_defects(Mesh(vertices, faces), Found(tuple(observations), tuple(defects), 0), settings, 1)
    assert painted.tolist() == [-1, 1, 1, -1, -1, -1, -1, -1, 0, -1]
    assert weight.tolist() == [0, 1, 1, 0, 0, 0, 0, 0, 1, 0]
