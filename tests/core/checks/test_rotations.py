from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from core.checks.rotations import check_rotations, disagreement, measured_rotations, worst_cut
from core.flags import Flag
from core.viewgraph import PairTable

F64 = NDArray[np.float64]

N = 40
FRAMES = np.arange(N)


def camera_path() -> F64:
    """A camera that turns by 1.5 degrees a frame and nods."""
    return Rotation.from_euler("yx", np.stack([1.5 * FRAMES, 5 * np.sin(FRAMES / 6)], 1), degrees=True).as_matrix()


def graph(rotations: F64, noise_deg: float = 0.3, window: int = 5, config: int = 2, inliers: int = 200) -> PairTable:
    rng = np.random.default_rng(0)
    pairs = np.array([(i, j) for i in range(N) for j in range(i + 1, min(i + window, N - 1) + 1)], np.int32)
    noise = Rotation.from_rotvec(np.radians(noise_deg) * rng.standard_normal((len(pairs), 3)) / np.sqrt(3))
    relative = Rotation.from_matrix(rotations[pairs[:, 1]] @ np.swapaxes(rotations[pairs[:, 0]], 1, 2)) * noise
    n = len(pairs)
    return PairTable(
        pairs=pairs,
        method=np.zeros(n, np.uint8),
        n_matches=np.full(n, inliers, np.int32),
        config=np.full(n, config, np.uint8),
        offsets=np.arange(n + 1) * inliers,
        inliers=np.zeros((n * inliers, 2), np.uint32),
        rotation_xyzw=relative.as_quat(),
        translation=np.zeros((n, 3)),
        triangulation_angle_deg=np.zeros(n, np.float32),
    )


def flag_of(model: F64, **kinds: int) -> Flag | None:
    return check_rotations(disagreement(measured_rotations(graph(camera_path(), **kinds)), FRAMES, model))


def test_a_straight_model_with_noisy_pairs_has_no_flag() -> None:
    assert flag_of(camera_path()) is None


def test_the_world_frame_of_the_model_does_not_matter() -> None:
    world = Rotation.from_euler("xyz", [40, -70, 120], degrees=True).as_matrix()
    assert flag_of(camera_path() @ world) is None


@pytest.mark.parametrize("bend_deg", [5.0, 7.0, 30.0])
def test_a_model_whose_second_half_is_turned_is_bent_at_the_seam(bend_deg: float) -> None:
    model = camera_path()
    model[20:] = model[20:] @ Rotation.from_euler("xyz", [0, 0, bend_deg], degrees=True).as_matrix()
    found = disagreement(measured_rotations(graph(camera_path())), FRAMES, model)
    flag = check_rotations(found)
    assert flag is not None
    assert (flag.code, flag.severity) == ("bent_model", "error")
    assert flag.where == "between frames 19 and 20"
    assert flag.value == pytest.approx(bend_deg, abs=0.5)
    assert found.median_deg < 1.0  # the median over all pairs alone would not have told


def test_a_model_that_turns_at_the_wrong_rate_is_bent_everywhere() -> None:
    model = Rotation.from_euler("yx", np.stack([2.4 * FRAMES, 5 * np.sin(FRAMES / 6)], 1), degrees=True).as_matrix()
    flag = flag_of(model)
    assert flag is not None
    assert flag.where.endswith("pairs of frames 0-39")


@pytest.mark.parametrize("kinds", [{"config": 4}, {"inliers": 20}])
def test_ill_conditioned_pairs_have_no_say(kinds: dict[str, int]) -> None:
    model = camera_path()
    model[20:] = model[20:] @ Rotation.from_euler("z", 30, degrees=True).as_matrix()
    assert flag_of(model, **kinds) is None


def test_only_pairs_inside_the_model_are_compared() -> None:
    registered = np.array([3, 4, 5, 30, 31])
    found = disagreement(measured_rotations(graph(camera_path())), registered, camera_path()[registered])
    assert found.pairs.tolist() == [[3, 4], [3, 5], [4, 5], [30, 31]]
    assert worst_cut(found) is None
    assert disagreement(measured_rotations(graph(camera_path())), FRAMES[:0], camera_path()[:0]).median_deg == 0.0
