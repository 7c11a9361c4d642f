"""Lines of sight in a scene of two walls: what is in front hides what is behind."""

from __future__ import annotations

import gc
from typing import Any

import cv2  # noqa: F401  # before pycolmap
import numpy as np
import pycolmap
import pytest

from core.mapping.surface import Surface
from core.scene.defect import Sighting
from core.scene.views import Views, views_of
from core.thesis.sightings import mean_normal, sample_points, sightings


def wall(z: float, half: float) -> tuple[np.ndarray, np.ndarray]:
    corners = np.array([[-half, -half, z], [half, -half, z], [half, half, z], [-half, half, z]])
    return corners, np.array([[0, 1, 2], [0, 2, 3]], np.int32)


def camera() -> Any:
    return pycolmap.Camera(model="PINHOLE", width=200, height=100, params=[100, 100, 100, 50], camera_id=1)


def views(*places: tuple[float, float]) -> Views:
    """One view per place (x, z), looking along +z; frames are numbered by position."""
    R = np.tile(np.eye(3), (len(places), 1, 1))
    return Views(np.arange(len(places)), R, np.array([[-x, 0.0, -z] for x, z in places]), camera())


BACK, NEAR = wall(10.0, 8.0), wall(5.0, 0.5)
VERTICES = np.vstack([BACK[0], NEAR[0]])
FACES = np.vstack([BACK[1], NEAR[1] + 4])
PLACE = np.array([[0, 0, 10.0], [0.1, 0, 10], [0, 0.1, 10]])
NORMAL = np.array([0.0, 0, -1])


def test_hidden_outside_behind_and_seen() -> None:
    around = views((0.0, 0.0), (6.0, 0.0), (30.0, 0.0), (0.0, 20.0), (0.0, 7.0))
    seen = sightings(PLACE, NORMAL, around, Surface(VERTICES, FACES), 0.01)
    assert [sighting.frame_index for sighting in seen] == [4, 1]
    assert seen[0].quality == 1.0
    assert seen[1].quality < 0.1


def test_the_tolerance_lets_through_what_lies_just_before() -> None:
    shifted = PLACE + np.array([0, 0, 0.05])
    blocked = sightings(shifted, NORMAL, views((0.0, 7.0)), Surface(VERTICES, FACES), 0.01)
    let_through = sightings(shifted, NORMAL, views((0.0, 7.0)), Surface(VERTICES, FACES), 0.1)
    assert (len(blocked), len(let_through)) == (0, 1)


def test_without_a_surface_nothing_hides() -> None:
    nothing = Surface(np.zeros((0, 3)), np.zeros((0, 3), np.int32))
    assert len(sightings(PLACE, np.zeros(3), views((0.0, 0.0)), nothing, 0.0)) == 1


def test_views_outlive_their_model() -> None:
    options = pycolmap.SyntheticDatasetOptions()
    options.num_rigs, options.num_frames_per_rig, options.num_points3D = 1, 4, 30
    model = pycolmap.synthesize_dataset(options)
    expected = {image.image_id - 1: image.projection_center() for image in model.images.values()}
    found = views_of(model)
    del model
    gc.collect()
    assert found.camera.width == 1024
    assert found.frame_index.tolist() == sorted(expected)
    for frame, center in zip(found.frame_index.tolist(), found.centers, strict=True):
        assert center == pytest.approx(expected[frame])


def test_quality_is_the_cosine_of_incidence_over_the_squared_distance() -> None:
    place, nothing = np.array([[0.0, 0, 10]]), Surface(np.zeros((0, 3)), np.zeros((0, 3), np.int32))
    best, oblique = sightings(place, NORMAL, views((3.0, 6.0), (0.0, 8.0)), nothing, 0.0)
    assert (best.frame_index, best.quality) == (1, 1.0)
    assert oblique.quality == pytest.approx((4 / 5 / 25) / (1 / 4))
    unknown = sightings(place, np.zeros(3), views((3.0, 6.0), (0.0, 8.0)), nothing, 0.0)
    assert unknown[1].quality == pytest.approx((1 / 25) / (1 / 4))


def test_a_view_counts_from_half_of_the_sample_points() -> None:
    """The image is 200 pixels wide at a focal length of 100: at depth 10 it ends 10 from the axis."""
    nothing = Surface(np.zeros((0, 3)), np.zeros((0, 3), np.int32))
    inside, outside = [0.0, 0, 10], [10.1, 0, 10]
    assert sightings(np.array([inside, outside]), NORMAL, views((0.0, 0.0)), nothing, 0.0)
    assert not sightings(np.array([inside, outside, outside]), NORMAL, views((0.0, 0.0)), nothing, 0.0)
    behind = np.array([[0.0, 0, -10]])
    assert not sightings(behind, NORMAL, views((0.0, 0.0)), nothing, 0.0)


def test_a_sighting_is_written_with_four_digits_and_its_place_with_five() -> None:
    bare = Sighting(3, 0.123456, detected=True).to_dict()
    assert bare == {"frame_index": 3, "quality": 0.1235, "detected": True}
    placed = Sighting(3, 0.123456, (0.1234567, 0.7654321)).to_dict()
    assert placed == {"frame_index": 3, "quality": 0.1235, "detected": False, "x": 0.12346, "y": 0.76543}


def test_sample_points_are_spread_over_all() -> None:
    support = np.arange(3000.0).reshape(1000, 3)
    sampled = sample_points(support)
    assert len(sampled) == 64
    assert sampled[0].tolist() == support[0].tolist()
    assert sampled[-1].tolist() == support[-1].tolist()
    assert sample_points(support[:5]) is not None
    assert len(sample_points(support[:5])) == 5


def test_mean_normal_is_weighted() -> None:
    normals = np.array([[1.0, 0, 0], [0, 1, 0], [0, 0, 1]])
    defect = np.array([0, 0, 1], np.int32)
    assert mean_normal(normals, defect, np.array([0.3, 0.4, 1], np.float32), 0) == pytest.approx(
        (0.6, 0.8, 0), abs=1e-6
    )
    assert not mean_normal(normals, defect, np.ones(3, np.float32), 5).any()
