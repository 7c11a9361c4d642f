from __future__ import annotations

import numpy as np
import pycolmap
import pytest

from core.geometry.boxes import Box
from core.mapping.support import observations_of, verified_detections
from core.settings.groups import MapperSettings
from core.sparse.cases import Case
from tests.core.sparse.scene import make_scene, model_of, view_graph, write_graph

N, FRAME = 12, 5


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory) -> pycolmap.Reconstruction:
    scene = make_scene(N)
    graph = write_graph(tmp_path_factory.mktemp("verified") / "graph", scene, view_graph(scene))
    return model_of(Case(graph, 0, N, MapperSettings(), 0))


def around(model: pycolmap.Reconstruction, count: int) -> tuple[Box, list[int]]:
    """A box in FRAME that holds just so many of the points that three views confirm, and their ids."""
    seen = observations_of(model.image(FRAME + 1))
    long = [i for i, k in enumerate(seen.point_ids) if model.point3D(int(k)).track.length() >= 3]
    xy = seen.xy[long]
    order = np.argsort(np.abs(xy - np.median(xy, axis=0)).max(axis=1))[:count]
    (x1, y1), (x2, y2) = xy[order].min(axis=0), xy[order].max(axis=0)
    box = (float(x1), float(y1), float(x2), float(y2))
    return box, [int(k) for k in seen.inside(box)]


def test_a_box_with_points_of_three_views_is_verified(model: pycolmap.Reconstruction) -> None:
    box, ids = around(model, 12)
    assert len(ids) >= 3
    boxes = {FRAME: [(box, "dent"), ((0.0, 0.0, 0.5, 0.5), "dent")], FRAME + 1: []}
    assert verified_detections(model, boxes) == 1


def test_what_two_views_see_verifies_nothing(model: pycolmap.Reconstruction) -> None:
    box, ids = around(model, 12)
    work = pycolmap.Reconstruction(model)
    for point_id in ids:
        elements = [(e.image_id, e.point2D_idx) for e in work.point3D(point_id).track.elements]
        others = [element for element in elements if element[0] != FRAME + 1]
        for image_id, keypoint in others[1:]:
            work.delete_observation(image_id, keypoint)
    assert {work.point3D(point_id).track.length() for point_id in ids} == {2}
    assert verified_detections(work, {FRAME: [(box, "dent")]}) == 0


def test_a_frame_that_is_not_registered_verifies_nothing(model: pycolmap.Reconstruction) -> None:
    box, _ = around(model, 12)
    assert verified_detections(model, {FRAME: [(box, "dent")], N + 3: [(box, "dent")]}) == 1
