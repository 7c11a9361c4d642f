"""The pictures of the surface at each defect."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from core.scene.defect import DefectRecord
from core.viewer.portraits import HEIGHT_PX, WIDTH_PX, write_portraits
from tests.core import making_plates as plates
from tests.core.making_results import RESULTS
from tests.web.making_page import FAR_FINDING, FRAMES, NEAR_FINDING, mesh_of_plates, records_of

_ORANGE_HUE = (5, 25)
"""Of OpenCV's 180 steps."""


def orange(path: Path) -> NDArray[np.bool_]:
    """(h, w) where a picture shows the colour of a defect."""
    read = cv2.imread(str(path))
    assert read is not None
    hue, saturation, _ = np.moveaxis(cv2.cvtColor(read, cv2.COLOR_BGR2HSV), 2, 0)
    marked: NDArray[np.bool_] = (hue >= _ORANGE_HUE[0]) & (hue <= _ORANGE_HUE[1]) & (saturation > 80)
    return marked


@pytest.mark.parametrize("page", ["two_models/viewer", "two_models/models/1/viewer"])
def test_every_defect_of_a_result_has_a_picture_that_the_document_names(page: str) -> None:
    document = json.loads((RESULTS / page / "viewer.json").read_text(encoding="utf-8"))
    assert document["defects"]
    for defect in document["defects"]:
        assert defect["surface_picture"] == f"surface/defect_{defect['id']:03d}.jpg"
        marked = orange(RESULTS / page / defect["surface_picture"])
        assert marked.shape == (HEIGHT_PX, WIDTH_PX)
        assert marked.any()


def test_a_picture_shows_the_defect_in_its_middle_and_the_surface_around_it(tmp_path: Path) -> None:
    mesh = mesh_of_plates()
    for number, record in zip((NEAR_FINDING, FAR_FINDING), records_of(mesh), strict=True):
        (tmp_path / str(number)).mkdir()
        assert write_portraits(tmp_path / str(number), mesh, plates.views(FRAMES), [record]) == [number]
        marked = orange(tmp_path / str(number) / "surface" / f"defect_{number:03d}.jpg")
        rows, columns = np.nonzero(marked)
        # The mesh is coarse: colours run into the next vertices.
        assert abs(rows.mean() - HEIGHT_PX / 2) < 0.1 * HEIGHT_PX
        assert abs(columns.mean() - WIDTH_PX / 2) < 0.1 * WIDTH_PX
        # Five radii are half the height, so a disc covers pi / 100 of a square of that height.
        assert 0.01 < marked.mean() < 0.06


def test_of_two_defects_in_sight_a_line_tells_which_is_meant(tmp_path: Path) -> None:
    mesh = mesh_of_plates()
    both, alone = tmp_path / "both", tmp_path / "alone"
    for folder, records in ((both, records_of(mesh)), (alone, records_of(mesh)[:1])):
        folder.mkdir()
        write_portraits(folder, mesh, plates.views(FRAMES), records)
    name = f"surface/defect_{NEAR_FINDING:03d}.jpg"
    shown = [cv2.imread(str(folder / name)) for folder in (both, alone)]
    assert shown[0] is not None
    assert shown[1] is not None
    # The far one is in sight on the right, and nothing else differs: it has the colour and no line.
    differing = np.abs(shown[0].astype(int) - shown[1]).max(axis=2) > 40
    assert differing.any()
    assert not differing[:, : WIDTH_PX // 2 + 100].any()
    assert (shown[0][differing].min(axis=1) < 150).all()


def test_a_defect_without_faces_or_without_a_registered_view_has_none(tmp_path: Path) -> None:
    mesh = mesh_of_plates()
    near, far = records_of(mesh)
    unseen = tuple(replace(view, frame_index=3) for view in far.frames)  # frame 3 has no pose
    records: list[DefectRecord] = [replace(near, faces=()), replace(far, frames=unseen)]
    assert write_portraits(tmp_path, mesh, plates.views(FRAMES), records) == []
    assert not (tmp_path / "surface").exists()
