from __future__ import annotations

import numpy as np
import pytest

from core.timeline.surface import defect_of_vertices, faces_of_defects, mean_normal, sample_points


def test_vertices_take_the_defect_of_their_strongest_detection() -> None:
    detection = np.array([-1, 4, 0, 9, -1], np.int32)
    assert defect_of_vertices(detection, {4: 1, 0: 0}).tolist() == [-1, 1, 0, -1, -1]
    assert defect_of_vertices(detection, {}).tolist() == [-1] * 5


def test_a_face_belongs_to_the_defect_of_two_of_its_vertices() -> None:
    faces = np.array([[0, 1, 2], [2, 3, 4], [1, 2, 3], [0, 4, 3]], np.int32)
    defect = np.array([0, 0, -1, 1, 1], np.int32)
    assert [own.tolist() for own in faces_of_defects(faces, defect, 2)] == [[0], [1, 3]]
    assert faces_of_defects(faces, defect, 0) == []


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
