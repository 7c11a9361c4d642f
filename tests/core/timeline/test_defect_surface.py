from __future__ import annotations

import numpy as np

from core.timeline.surface import defect_of_vertices, faces_of_defects


def test_vertices_take_the_defect_of_their_strongest_detection() -> None:
    detection = np.array([-1, 4, 0, 9, -1], np.int32)
    assert defect_of_vertices(detection, {4: 1, 0: 0}).tolist() == [-1, 1, 0, -1, -1]
    assert defect_of_vertices(detection, {}).tolist() == [-1] * 5


def test_a_face_belongs_to_the_defect_of_two_of_its_vertices() -> None:
    faces = np.array([[0, 1, 2], [2, 3, 4], [1, 2, 3], [0, 4, 3]], np.int32)
    defect = np.array([0, 0, -1, 1, 1], np.int32)
    assert [own.tolist() for own in faces_of_defects(faces, defect, 2)] == [[0], [1, 3]]
    assert faces_of_defects(faces, defect, 0) == []
