"""Text that is burned in is found; a scene that stands still, stalls or shines is left alone."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from core.errors import StageFailed
from core.video.still import MAX_SHARE, find_still

SIZE = (180, 240)


def texture(seed: int = 0, width: int = 900) -> NDArray[np.uint8]:
    noise = np.random.default_rng(seed).random((SIZE[0], width)).astype(np.float32)
    smooth = cv2.GaussianBlur(noise, (0, 0), 2.0)
    scaled = (smooth - smooth.min()) / np.ptp(smooth)
    return np.asarray(30 + 180 * scaled).astype(np.uint8)


def moving(count: int = 30, step: int = 11) -> list[NDArray[np.uint8]]:
    wall = texture()
    return [wall[:, step * i : step * i + SIZE[1]].copy() for i in range(count)]


def with_text(frames: list[NDArray[np.uint8]]) -> tuple[list[NDArray[np.uint8]], NDArray[np.bool_]]:
    label = np.zeros(SIZE, np.uint8)
    cv2.putText(label, "PROBE 6MM", (20, 40), cv2.FONT_HERSHEY_SIMPLEX, 0.9, 255, 2)
    cv2.circle(label, (190, 130), 6, 255, -1)
    return [np.where(label > 0, np.uint8(250), frame) for frame in frames], label > 0


def saved(folder: Path, frames: list[NDArray[np.uint8]]) -> list[Path]:
    paths = []
    for i, frame in enumerate(frames):
        paths.append(folder / f"{i:04d}.jpg")
        cv2.imwrite(str(paths[-1]), frame, [cv2.IMWRITE_JPEG_QUALITY, 95])
    return paths


def test_burned_in_text_is_found_and_little_else(tmp_path: Path) -> None:
    frames, text = with_text(moving())
    found = find_still(saved(tmp_path, frames))
    assert found.mask[text].mean() > 0.9
    near = cv2.dilate(text.astype(np.uint8), np.ones((15, 15), np.uint8)) > 0
    assert found.mask[~near].mean() < 0.01
    assert found.share == pytest.approx(found.mask.mean())
    assert 0.01 < found.share < MAX_SHARE


def test_a_scene_without_text_has_no_still_pixels(tmp_path: Path) -> None:
    assert find_still(saved(tmp_path, moving())).share < 0.002


def test_nothing_is_masked_where_nothing_moves(tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    wall = texture()[:, : SIZE[1]].astype(int)
    frames = [np.clip(wall + rng.normal(0, 6, SIZE), 0, 255).astype(np.uint8) for _ in range(20)]
    assert find_still(saved(tmp_path, frames)).share == 0.0


def test_a_long_stall_is_no_overlay(tmp_path: Path) -> None:
    frames = moving(12)
    stalled = [*frames[:6], *[frames[6]] * 25, *frames[6:]]
    assert find_still(saved(tmp_path, stalled)).share < 0.002


def test_smooth_light_that_stays_is_no_overlay(tmp_path: Path) -> None:
    y, x = np.mgrid[0 : SIZE[0], 0 : SIZE[1]]
    light = 90 * np.exp(-((x - 120) ** 2 + (y - 90) ** 2) / 2500.0)
    frames = [np.clip(frame.astype(float) * 0.6 + light, 0, 255).astype(np.uint8) for frame in moving()]
    assert find_still(saved(tmp_path, frames)).share < 0.002


def test_no_frames_and_no_picture(tmp_path: Path) -> None:
    with pytest.raises(StageFailed):
        find_still([])
    (tmp_path / "0000.jpg").write_bytes(b"no picture")
    with pytest.raises(StageFailed, match=r"0000\.jpg"):
        find_still([tmp_path / "0000.jpg"])
