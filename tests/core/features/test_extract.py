from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from core.errors import StageFailed
from core.features.extract import inside_mask, make_extractor, read_image, working_size
from core.features.io import FrameFeatures, read_features, write_features
from core.settings import make_settings


def _blobs(width: int = 240, height: int = 180) -> np.ndarray:
    """Bright Gaussian spots at known places on black; RGB."""
    image = np.zeros((height, width), np.float32)
    y, x = np.mgrid[0:height, 0:width]
    for cx, cy in _CENTRES:
        # the spot's centre in COLMAP's convention: a pixel's centre is at +0.5
        image += 220 * np.exp(-((x + 0.5 - cx) ** 2 + (y + 0.5 - cy) ** 2) / (2 * 4.0**2))
    return np.repeat(np.clip(image, 0, 255).astype(np.uint8)[:, :, None], 3, axis=2)


_CENTRES = np.array([[60.3, 50.8], [150.6, 40.2], [80.5, 130.4], [190.2, 120.7]])


def test_working_size_never_grows() -> None:
    settings = make_settings().features
    assert working_size(787, 525, settings) == (787, 525)
    assert working_size(3200, 1600, settings) == (1600, 800)
    half = make_settings(options={"features.scale": 0.5}).features
    assert working_size(3200, 1600, half) == (800, 400)


@pytest.mark.parametrize("scale", [1.0, 0.5])
def test_sift_keypoints_come_back_in_crop_pixels(scale: float) -> None:
    settings = make_settings(options={"features.method": "sift", "features.scale": scale}).features
    features = make_extractor(settings)(_blobs())
    assert features.descriptors.dtype == np.uint8
    assert np.all(np.diff(features.scores) <= 0)
    for centre in _CENTRES:
        nearest = np.linalg.norm(features.keypoints - centre, axis=1).min()
        assert nearest < 0.3, f"no keypoint near {centre}"


@pytest.mark.parametrize("scale", [1.0, 0.5])
def test_disk_keypoints_come_back_in_crop_pixels(scale: float) -> None:
    image = np.zeros((160, 224, 3), np.uint8)
    rng = np.random.default_rng(1)
    image[48:112, 64:160] = np.kron(rng.integers(0, 256, (8, 12, 3)), np.ones((8, 8, 1)))
    options = {"features.scale": scale, "features.max_keypoints": 200, "features.subpixel": False}
    features = make_extractor(make_settings(options=options).features)(image)
    assert features.descriptors.dtype == np.float16
    np.testing.assert_allclose(np.linalg.norm(features.descriptors.astype(float), axis=1), 1, atol=2e-3)
    assert np.all(np.diff(features.scores) <= 0)
    # whole pixels of the detected image, taken back by its scale
    grid = features.keypoints * scale - 0.5
    np.testing.assert_allclose(grid, np.rint(grid), atol=1e-4)
    corner_x, corner_y = features.keypoints.T
    inside = (corner_x > 60) & (corner_x < 164) & (corner_y > 44) & (corner_y < 116)
    assert inside[:40].mean() > 0.9


def test_subpixel_moves_by_less_than_a_pixel() -> None:
    image = np.kron(np.random.default_rng(2).integers(0, 256, (16, 16, 3)), np.ones((6, 6, 1))).astype(np.uint8)
    whole, fine = (
        make_extractor(make_settings(options={"features.subpixel": on}).features)(image) for on in (False, True)
    )
    moved = np.abs(fine.keypoints - whole.keypoints)
    assert 0 < moved.max() <= 0.5
    np.testing.assert_array_equal(whole.descriptors, fine.descriptors)


def test_mask_keeps_what_lies_on_true_pixels() -> None:
    mask = np.zeros((6, 8), np.bool_)
    mask[2, 3] = True
    keypoints = np.array([[3.5, 2.5], [4.0, 2.5], [3.99, 2.01], [3.5, 3.2]], np.float32)
    features = FrameFeatures(keypoints, np.arange(4, dtype=np.float32), np.zeros((4, 128), np.float16))
    assert inside_mask(features, mask).scores.tolist() == [0, 2]


def test_files_round_trip_and_have_the_same_bytes(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    features = FrameFeatures(
        rng.random((5, 2), np.float32), rng.random(5, np.float32), rng.random((5, 128)).astype(np.float16)
    )
    write_features(tmp_path / "a.npz", features)
    write_features(tmp_path / "b.npz", features)
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()
    back = read_features(tmp_path / "a.npz")
    np.testing.assert_array_equal(back.descriptors, features.descriptors)


def test_unreadable_files_are_named(tmp_path: Path) -> None:
    (tmp_path / "0001.jpg").write_bytes(b"no image")
    with pytest.raises(StageFailed, match=r"0001\.jpg"):
        read_image(tmp_path / "0001.jpg")
    with pytest.raises(StageFailed, match=r"0002\.npz"):
        read_features(tmp_path / "0002.npz")
    cv2.imwrite(str(tmp_path / "red.png"), np.full((4, 4, 3), (0, 0, 255), np.uint8))
    assert read_image(tmp_path / "red.png")[0, 0].tolist() == [255, 0, 0]
