"""Exported frames are those of the frame table, cropped and in order."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from core.errors import StageFailed
from core.frames.export import export_frames
from core.frames.sampling import ChosenFrame
from core.scene.frame import Crop, Role, SourceFrame
from core.video.decode import iter_frames
from core.video.probe import probe_video
from tests.core.making_videos import every_ms, make_video

CROP = Crop(10, 20, 150, 120, 160, 128)


def test_each_image_is_the_crop_of_its_source_frame(tmp_path: Path) -> None:
    video = make_video(tmp_path / "a.mp4", every_ms(40, 12))
    frames = [rgb for *_, rgb in iter_frames(video)]
    chosen = [
        ChosenFrame(0, SourceFrame(0, 2), Role.SAMPLED),
        ChosenFrame(1, SourceFrame(0, 9), Role.BOTH),
        ChosenFrame(2, SourceFrame(0, 5), Role.ADDED),
    ]
    seen: list[int] = []
    export_frames(video, probe_video(video), chosen, CROP, tmp_path, jpeg_quality=100, on_frame=seen.append)
    assert sorted(path.name for path in tmp_path.glob("*.jpg")) == ["0000.jpg", "0001.jpg", "0002.jpg"]
    for frame in chosen:
        coded = cv2.imread(str(tmp_path / f"{frame.index:04d}.jpg"))
        assert coded is not None
        image = coded[..., ::-1]
        expected = frames[frame.source.source_index][20:120, 10:150]
        assert image.shape == (100, 140, 3)
        assert np.abs(image.astype(int) - expected).mean() < 3
    assert seen == list(range(1, 11)), "decoding stops after the last frame that is wanted"


def test_another_video_under_the_same_name_is_noticed(tmp_path: Path) -> None:
    table = probe_video(make_video(tmp_path / "a.mp4", every_ms(40, 6)))
    other = make_video(tmp_path / "b.mp4", every_ms(40, 6), size=(176, 144))
    with pytest.raises(StageFailed, match="changed since it was probed"):
        export_frames(other, table, [ChosenFrame(0, SourceFrame(0, 1), Role.SAMPLED)], CROP, tmp_path, jpeg_quality=90)
