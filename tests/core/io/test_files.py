"""What the files between stages hold comes back, and their bytes are those that results have had."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from core.errors import StageFailed
from core.io.annotations import read_detections, read_rows, write_annotations, write_rows
from core.io.frames import read_crop, read_frames, read_registered, write_frames, write_registered
from core.io.sparse import has_model, read_model, read_poses, write_cameras, write_model
from core.io.timeline import read_defects, read_events, write_timeline
from core.scene.defect import EventRow
from core.scene.detection import Mask
from core.scene.frame import Crop, SourceFrame
from core.scene.views import views_of
from tests.core import making_plates as plates
from tests.core.making_rows import defect, detection, mapped, run_frames, unplaced


def test_detections_are_compact_and_rows_are_not(tmp_path: Path) -> None:
    mask = Mask("blade", ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0)))
    write_annotations(
        tmp_path,
        [detection(box=(0.25, 0.25, 0.5, 0.5))],
        {SourceFrame(0, 12): (mask,), SourceFrame(0, 3): ()},
        [SourceFrame(0, 3), SourceFrame(0, 12)],
    )
    assert (tmp_path / "detections.json").read_text() == (
        '[{"id":0,"key":"1.0000","time_s":1.0,"label":"dent","score":0.9,"box":[0.25,0.25,0.5,0.5],'
        '"polygon":null,"track_id":null,"source_index":10}]\n'
    )
    assert (tmp_path / "masks.json").read_text() == (
        '{"3":[],"12":[{"label":"blade","polygon":[[0.0,0.0],[1.0,0.0],[1.0,1.0]]}]}\n'
    )
    assert (tmp_path / "looked_at.json").read_text() == "[3,12]\n"
    rows = [mapped(0, (1.0, 2.0, 3.0)), unplaced(1)]
    write_rows(tmp_path, rows)
    assert read_rows(tmp_path) == rows
    assert (tmp_path / "detections.json").read_text().startswith('[\n {\n  "id": 0,\n  "key": "1.0000",\n')
    with pytest.raises(KeyError):
        read_detections(tmp_path)


def test_frames_and_crop(tmp_path: Path) -> None:
    frames, crop = run_frames(2, 0.5), Crop(1, 2, 101, 82, 200, 100)
    write_frames(tmp_path, frames, crop)
    write_registered(tmp_path, [0, 1])
    assert (read_frames(tmp_path), read_crop(tmp_path), read_registered(tmp_path)) == (frames, crop, [0, 1])
    text = (tmp_path / "frames.json").read_text()
    assert text.startswith(
        '[\n {\n  "index": 0,\n  "source_index": 0,\n  "pts": 0,\n  "time_s": 0.0,\n  "sha256": "",\n'
    )
    assert text.endswith('  "role": "both"\n }\n]\n')
    assert (tmp_path / "crop.json").read_text() == (
        '{"x0": 1, "y0": 2, "x1": 101, "y1": 82, "source_width": 200, "source_height": 100}\n'
    )
    assert (tmp_path / "registered.json").read_text() == "[0, 1]"


def test_events_and_defects(tmp_path: Path) -> None:
    event = EventRow(0, 0, "dent", 0.0, 1.0, 1, 1, 0.0, 0.0, 0.0, 0.5, None)
    write_timeline(tmp_path, [event], [defect(0)], [{"id": 0}])
    assert (read_events(tmp_path), read_defects(tmp_path)) == ([event], [defect(0)])
    assert (tmp_path / "confidence.json").read_text() == '[\n {\n  "id": 0\n }\n]\n'


def test_models_and_cameras(tmp_path: Path) -> None:
    plates.write_model(tmp_path / "model", [0, 2, 5])
    model = read_model(tmp_path)
    write_model(tmp_path / "further", model, 2)
    assert not has_model(tmp_path / "further")
    assert (tmp_path / "further" / "2" / "model" / "images.bin").is_file()
    again = read_model(tmp_path / "further", 2)
    assert sorted(again.reg_image_ids()) == [1, 3, 6]
    views = views_of(again)
    write_cameras(tmp_path, views)
    poses = read_poses(tmp_path)
    assert (poses[:, :, :3] == views.R).all()
    assert (poses[:, :, 3] == views.t).all()
    with np.load(tmp_path / "cameras.npz") as data:
        assert data["frame_index"].tolist() == [0, 2, 5]
    with pytest.raises(StageFailed, match="no sparse model"):
        read_model(tmp_path / "none")
