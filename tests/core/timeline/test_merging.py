"""Groups that differ only by a depth that no box shows are one defect; everything else stays apart."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from core.mapping.observations import Observation
from core.mapping.surface_rules import place_on_surface
from core.timeline.merging import merge_alike
from tests.core import making_plates as plates
from tests.core.making_plates import CROP, NEAR, detection, scene, times, views

FRAMES = range(10)
A = (-0.8, 0.2, NEAR)


def seen(places: list[tuple[float, float, float]]) -> list[Observation]:
    """Every place in every frame."""
    made = [detection(len(FRAMES) * n + frame, place, frame) for n, place in enumerate(places) for frame in FRAMES]
    return place_on_surface(made, scene(FRAMES, made), times(), plates.no_matches, 0.4)


def pushed(one: Observation, depth: float) -> Observation:
    """The same sight, its place further along the line of sight: on a stray sheet."""
    center = views(FRAMES).centers[int(one.row.frame_index or 0)]
    place = np.array([one.row.x, one.row.y, one.row.z], np.float64)
    x, y, z = place + depth * (place - center) / np.linalg.norm(place - center)
    return replace(one, row=replace(one.row, x=float(x), y=float(y), z=float(z)))


def merged(groups: list[list[int]], observations: list[Observation]) -> list[list[int]]:
    return merge_alike(groups, observations, views(FRAMES), CROP)


def test_places_on_two_sheets_are_one_defect() -> None:
    observations = [pushed(one, 0.25 * (k % 2)) for k, one in enumerate(seen([A]))]
    groups = [list(range(0, 10, 2)), list(range(1, 10, 2))]
    assert merged(groups, observations) == [list(range(10))]
    assert merged([*groups[::-1]], observations) == [list(range(10))]


def test_a_sheet_that_some_boxes_tell_apart_stays() -> None:
    observations = [pushed(one, 1.6 * (k % 2)) for k, one in enumerate(seen([A]))]
    groups = [list(range(0, 10, 2)), list(range(1, 10, 2))]
    assert merged(groups, observations) == groups


def test_neighbours_labels_and_frames_that_show_two_keep_groups_apart() -> None:
    beside = seen([A, (A[0] + 0.45, A[1], A[2])])
    apart = [list(range(10)), list(range(10, 20))]
    assert merged(apart, beside) == apart

    observations = [pushed(one, 0.25 * (k % 2)) for k, one in enumerate(seen([A]))]
    groups = [list(range(0, 10, 2)), list(range(1, 10, 2))]
    other = [replace(o, row=replace(o.row, label="nick")) if k % 2 else o for k, o in enumerate(observations)]
    assert merged(groups, other) == groups

    row = observations[1].row
    twice = [*observations]
    twice[1] = replace(twice[1], row=replace(row, frame_index=0, box_x1=row.box_x2, box_x2=2 * row.box_x2 - row.box_x1))
    assert merged(groups, twice) == groups


def test_nothing_to_merge() -> None:
    assert merged([], []) == []
