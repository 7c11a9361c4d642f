"""Observations to defects: what is one, what are two, what is none; visits, persistence, confidence."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from core.mapping.observations import Observation
from core.mapping.surface_rules import place_on_surface
from core.scene.detection import Detection
from core.scene.frame import RunFrames
from core.timeline.defects import Found, defect_records, event_rows, find_defects
from core.timeline.instances import existence, fused_place, group_observations
from core.timeline.seen import views_of_place, visits
from core.videos import moment
from tests.core import making_plates as plates
from tests.core.making_plates import NEAR, detection, scene, times

FRAMES = range(10)
A, B = (-0.8, 0.2, NEAR), (-0.35, 0.2, NEAR)


def found_in(detections: Sequence[Detection], frames: Sequence[int] = FRAMES, **more: object) -> Found:
    made = scene(frames, detections, **more)  # type: ignore[arg-type]
    observations = place_on_surface(detections, made, times(), plates.no_matches, 0.4)
    return find_defects(observations, made, times().moment_of_index)


def in_turn(places: Sequence[tuple[float, float, float]], frames: Sequence[int] = FRAMES) -> list[Detection]:
    """Every place in every frame."""
    made = [(place, frame) for frame in frames for place in places]
    return [detection(i, place, frame) for i, (place, frame) in enumerate(made)]


def test_one_place_is_one_defect_and_its_neighbour_another() -> None:
    found = found_in(in_turn([A, B]))
    assert [len(defect.members) for defect in found.defects] == [10, 10]
    for defect, place in zip(found.defects, (A, B), strict=True):
        assert defect.place == pytest.approx(place, abs=0.02)
        assert (defect.k, defect.n) == (10, 10)
        assert defect.exists > 0.99
    assert [one.row.defect_id for one in found.observations] == [0, 1] * 10
    assert found.unconfirmed == 0


def test_two_boxes_apart_in_one_frame_are_two_defects() -> None:
    """Nearer to each other than a patch's radius, but always seen as two."""
    close = (A[0] + 0.17, A[1], A[2])
    alone = [detection(i, place, i) for i, place in enumerate([A, close] * 5)]
    assert len(found_in(alone).defects) == 1
    small = [replace(one, box=_narrowed(one.box)) for one in in_turn([A, close])]
    assert len(found_in(small).defects) == 2


def _narrowed(box: tuple[float, float, float, float]) -> tuple[float, float, float, float]:
    """Half as wide, so that two of them do not overlap."""
    x1, y1, x2, y2 = box
    return (0.7 * x1 + 0.3 * x2, y1, 0.3 * x1 + 0.7 * x2, y2)


def test_labels_and_tracks_have_their_say() -> None:
    shifted = (A[0] + 0.2, A[1], A[2])
    dents = [detection(i, A, i) for i in range(0, 10, 2)]
    others = [detection(10 + i, shifted, i, label="nick") for i in range(1, 10, 2)]
    assert len(found_in([*dents, *others]).defects) == 2
    same = [replace(one, label="dent") for one in others]
    assert len(found_in([*dents, *same]).defects) == 1
    far = (A[0] + 0.3, A[1], A[2])
    tracked = [detection(i, A if i % 2 else far, i, track_id="7") for i in FRAMES]
    untracked = [replace(one, track_id=None) for one in tracked]
    assert len(found_in(untracked).defects) == 2
    assert len(group_observations(_placed(tracked))) <= len(group_observations(_placed(untracked)))


def test_one_track_reaches_twice_as_far_and_over_labels() -> None:
    """A place that no other rule joins: too far for its distance, and another label than its neighbours have."""
    some = _placed(in_turn([A]))[:7]
    reach = some[0].radius + (some[0].sigma or 0.0)

    def at(k: int, shift: float, label: str, track: str | None) -> Observation:
        row = replace(some[k].row, x=A[0] + shift * reach, y=A[1], z=A[2], label=label)
        return replace(some[k], row=row, track_id=track, radius=some[0].radius, sigma=some[0].sigma)

    def groups(track: str | None, video: int = 0) -> list[list[int]]:
        middle = [at(k, 0.75, "dent", None) for k in range(1, 6)]
        last = at(6, 1.55, "nick", track)
        last = replace(last, row=replace(last.row, video=video))
        return group_observations([at(0, 0.0, "dent", "7"), *middle, last])

    assert [len(members) for members in groups("7")] == [7]
    assert [len(members) for members in groups("8")] == [6, 1]
    assert [len(members) for members in groups(None)] == [6, 1]
    assert [len(members) for members in groups("7", video=1)] == [6, 1], "every file numbers its tracks by itself"


def _placed(detections: Sequence[Detection]) -> list[Observation]:
    return place_on_surface(detections, scene(FRAMES, detections), times(), plates.no_matches, 0.4)


def test_what_most_frames_deny_makes_no_record_and_stays_in_the_table() -> None:
    frames = list(range(10))
    real = in_turn([A], frames)
    invented = detection(len(real), (-1.6, -0.6, NEAR), 2)
    twice = [invented, detection(len(real) + 1, (-1.6, -0.6, NEAR), 7)]
    once = found_in([*real, invented])
    assert len(once.defects) == 1
    assert once.observations[-1].row.outcome == "approximate"
    again = found_in([*real, *twice])
    assert len(again.observations) == len(real) + 2
    assert len(again.defects) in (1, 2)
    kept = [one.row.confidence for one in again.observations[:10]]
    least = min(value for value in kept if value is not None)
    assert None not in kept
    assert all((one.row.confidence or 0.0) < least for one in again.observations[10:])


def test_frames_that_show_it_smaller_than_any_box_are_not_asked() -> None:
    detections = in_turn([A], range(4))
    made = scene(FRAMES, detections)
    observations = place_on_surface(detections, made, times(), plates.no_matches, 0.4)
    t = made.views.t.copy()
    t[5:, 2] += 6.0  # the cameras of the later frames stand far back
    back = replace(made, views=replace(made.views, t=t))
    near, far = (find_defects(observations, one, times().moment_of_index).defects[0] for one in (made, back))
    assert (near.k, near.n) == (4, 10)
    assert (far.k, far.n) == (4, 5)
    assert far.exists > near.exists


def test_existence_weighs_hits_against_misses() -> None:
    assert existence(1, 1, 0.5) > 0.9
    assert existence(1, 12, 0.5) < 0.1
    assert existence(6, 12, 0.5) > 0.99
    assert existence(1, 12, 0.1) > existence(1, 12, 0.5), "a weak detector's silence says little"
    assert existence(500, 900, 0.6) <= 1.0


def test_a_fused_place_leans_on_the_sure_ones_and_forgets_strays() -> None:
    observations = _placed(in_turn([A]))
    stray = replace(observations[0], row=replace(observations[0].row, x=A[0] + 1.0))
    place, sigma = fused_place([*observations, stray])
    assert place == pytest.approx(A, abs=0.02)
    assert 0.0 < sigma < observations[0].sigma  # type: ignore[operator]
    blurred = replace(stray, row=replace(stray.row, x=A[0] + 0.1), sigma=10.0)
    place, _ = fused_place([observations[1], blurred])
    assert place[0] == pytest.approx(observations[1].row.x, abs=1e-3)


def test_visits_end_when_the_place_is_out_of_sight() -> None:
    at = {i: 0.2 * i for i in range(20)}
    assert visits([1, 2, 9, 10], list(range(20)), at) == [[1, 2, 9, 10]], "missed, but in sight"
    assert visits([1, 2, 9, 10], [0, 1, 2, 3, 8, 9, 10], at) == [[1, 2], [9, 10]]
    assert visits([1, 4], [1, 4], at) == [[1, 4]], "0.2 s out of sight is nothing"
    assert visits([], [1], at) == []


def test_a_visit_ends_after_three_frames_out_of_sight_that_last_half_a_second() -> None:
    at = {i: 0.25 * i for i in range(20)}
    assert visits([1, 5], [1, 5], at) == [[1], [5]], "frames 2, 3, 4: 0.5 s"
    assert visits([1, 4], [1, 4], at) == [[1, 4]], "frames 2, 3 only"
    assert visits([1, 6], [1, 2, 6], at) == [[1], [6]], "frames 3, 4, 5"
    assert visits([1, 5], [1, 2, 5], at) == [[1, 5]], "frames 3, 4 only"
    assert visits([1, 5], [1, 5], {i: 0.24 * i for i in range(20)}) == [[1, 5]], "0.48 s"


def test_a_visit_ends_with_its_video() -> None:
    at = {0: 0.0, 1: 0.1, 2: moment(1, 0.0), 3: moment(1, 0.1)}
    assert visits([0, 1, 2, 3], [0, 1, 2, 3], at) == [[0, 1], [2, 3]]


def test_an_event_is_of_one_video_and_ordered_by_it() -> None:
    """Frames 5 to 9 are a second video, whose times begin anew."""
    whole = times()
    rows = [replace(f, video=1, time_s=f.time_s - 0.5) if f.index >= 5 else f for f in whole]
    frames = RunFrames(tuple(rows))
    moved = [
        replace(one, video=1, source_index=one.source_index, time_s=one.time_s - 0.5) if one.source_index >= 5 else one
        for one in in_turn([A])
        if one.source_index is not None
    ]
    observations = place_on_surface(moved, scene(FRAMES, moved), frames, plates.no_matches, 0.4)
    found = find_defects(observations, scene(FRAMES, moved), frames.moment_of_index)
    events = event_rows(found, frames.moment_of_index)
    assert len(found.defects) == 1
    assert [(event.video, event.n_detections) for event in events] == [(0, 5), (1, 5)]
    assert events[0].start_s == events[1].start_s == 0.0
    assert [event.end_s for event in events] == pytest.approx([0.4, 0.4])


def test_events_and_records_agree() -> None:
    found = found_in(in_turn([A, B]))
    events = event_rows(found, times().moment_of_index)
    assert [(event.event_id, event.defect_id, event.n_frames) for event in events] == [(0, 0, 10), (1, 1, 10)]
    first = defect_records(found, events, [[1, 2], [3]], 0)[0].to_dict()
    assert first["persistence"] == {"k": 10, "n": 10, "share": 1.0}
    assert first["detections"] == list(range(0, 20, 2))
    assert first["faces"] == [1, 2]
    assert first["confidence"]["parts"]["observations"] == 10
    assert 0.5 < first["confidence"]["value"] <= 1.0
    assert [frame["quality"] for frame in first["frames"]] == sorted(
        (frame["quality"] for frame in first["frames"]), reverse=True
    )
    nearest = min(FRAMES, key=lambda frame: abs(plates.STEP * frame - A[0]))
    assert first["frames"][0]["frame_index"] == nearest


def test_a_place_that_a_view_cannot_show_has_no_pixel() -> None:
    """The sampled surface may be in view where the place itself is behind the camera."""
    made = scene(FRAMES)
    points = np.array(A) + np.zeros((4, 3))
    facing = np.array([0.0, 0.0, -1.0])
    behind = np.array([0.0, 0.0, -5.0])
    seen = views_of_place(points, facing, made.views, made.surface, made.tolerance, behind, made.crop)
    assert len(seen) == len(FRAMES)
    assert all(one.at is None and "x" not in one.to_dict() for one in seen)
    shown = views_of_place(points, facing, made.views, made.surface, made.tolerance, np.array(A), made.crop)
    assert all(one.at is not None and 0 < one.at[0] < 1 for one in shown)


def test_estimates_join_a_defect_and_make_none() -> None:
    frames = [0, 1, 2, 3, 5, 6, 7, 8]
    detections = [*in_turn([A], frames), detection(8, A, 4), detection(9, (-2.0, -1.0, NEAR), 4)]
    found = found_in(detections, frames)
    assert len(found.defects) == 1
    assert [(one.row.outcome, one.row.defect_id) for one in found.observations[8:]] == [
        ("approximate", 0),
        ("approximate", None),
    ]
    records = defect_records(found, event_rows(found, times().moment_of_index), [[]], 0)
    assert records[0].approximate_detections == (8,)


def test_the_unit_changes_nothing_but_the_numbers() -> None:
    detections = in_turn([A, B])
    small, large = found_in(detections), found_in(detections, scale=1000.0)
    assert [d.members for d in small.defects] == [d.members for d in large.defects]
    for a, b in zip(small.defects, large.defects, strict=True):
        assert b.place == pytest.approx(1000 * a.place, rel=1e-4)
        assert b.sigma == pytest.approx(1000 * a.sigma, rel=1e-2)
    confidences = [[one.row.confidence for one in found.observations] for found in (small, large)]
    assert np.array(confidences[0], float) == pytest.approx(np.array(confidences[1], float), abs=0.01)
