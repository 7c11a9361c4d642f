"""Numbers of events and records, of groups and of existence, against closed forms."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from core.mapping.observations import Observation
from core.mapping.surface_rules import place_on_surface
from core.scene.defect import Extent
from core.timeline.defects import Defect, Found, defect_records, event_rows, find_defects
from core.timeline.instances import existence, fused_place, group_observations
from tests.core import making_plates as plates
from tests.core.making_plates import NEAR, detection, scene, times
from tests.core.making_rows import mapped

A = (-0.8, 0.2, NEAR)
TIMES_S = times().moment_of_index


def observation(number: int, x: float, radius: float = 0.25, sigma: float | None = 0.1, **more: object) -> Observation:
    """A mapped detection at (x, 0, 0) with one point of surface, a second after the one before."""
    row = mapped(number, (x, 0.0, 0.0), float(number), frame=number, **more)  # type: ignore[arg-type]
    place = np.array([[x, 0.0, 0.0]])
    return Observation(
        row, place, np.array([0.0, 0.0, 1.0]), radius, sigma, None, np.zeros(0, np.int64), np.zeros((0, 3))
    )


def found_of(own: Sequence[Observation], visits: Sequence[tuple[int, ...]]) -> Found:
    place = np.array([0.0, 0.0, 0.0])
    defect = Defect(tuple(range(len(own))), place, 0.1, place, (), len(own), len(own), 0.9, tuple(visits))
    return Found(tuple(replace(one, row=replace(one.row, defect_id=0)) for one in own), (defect,), 0)


def test_an_event_lasts_from_its_first_detection_to_its_last() -> None:
    own = [observation(k, x) for k, x in enumerate((0.0, 0.3, 0.9, 5.0, 5.1))]
    first, second = event_rows(found_of(own, [(0, 1, 2), (3, 4)]), TIMES_S)
    assert (first.event_id, first.start_s, first.end_s, first.n_detections, first.n_frames) == (0, 0.0, 2.0, 3, 3)
    assert (second.event_id, second.start_s, second.end_s, second.n_detections, second.n_frames) == (1, 3.0, 4.0, 2, 2)
    assert (first.x, first.y, first.z) == pytest.approx((0.4, 0.0, 0.0))
    assert first.radius == pytest.approx(0.5), "the farthest detection from their middle"
    assert second.radius == pytest.approx(0.05)


def test_the_extent_is_a_diameter_with_the_spread_of_its_detections() -> None:
    """1.4826 times the median distance from the median is the standard deviation of a normal distribution."""
    own = [observation(k, 0.0, radius) for k, radius in enumerate((0.1, 0.15, 0.3, 0.35, 2.0))]

    def extent(count: int) -> Extent:
        (record,) = defect_records(found_of(own[:count], []), [], [[]], 0)
        assert record.extent is not None
        return record.extent

    assert extent(5).value == pytest.approx(0.6)
    assert extent(5).sigma == pytest.approx(1.4826 * 0.3)
    assert extent(3).sigma == pytest.approx(1.4826 * 0.1)
    assert extent(2).sigma is None


def test_equally_sure_places_give_their_mean_and_its_error() -> None:
    """Of n places with one sigma that lie near each other, the error of the mean is sigma / sqrt(n)."""
    place, sigma = fused_place([observation(k, x, sigma=1.0) for k, x in enumerate((-1e-3, 0.0, 0.0, 1e-3))])
    assert place == pytest.approx([0.0, 0.0, 0.0], abs=1e-9)
    assert sigma == pytest.approx(0.5, rel=1e-4)


def test_places_that_lie_further_apart_than_foreseen_are_less_sure() -> None:
    """The mean square of the distances counts per axis of space; far within three sigma all weigh alike."""
    xs = np.array([-0.3, -0.1, 0.1, 0.3])
    _, sigma = fused_place([observation(k, float(x), sigma=0.05) for k, x in enumerate(xs)])
    weight = 1.0 / (1.0 + (xs / 0.15) ** 2)
    spread = (weight * xs**2).sum() / weight.sum() / 3.0
    assert sigma == pytest.approx(np.sqrt(spread * (weight**2).sum()) / weight.sum(), rel=1e-6)


def test_the_middle_of_a_group_leans_on_the_surer_ones() -> None:
    """By inverse variances; a group and a place join when their middles are no further apart than their reach."""

    def groups(last: float) -> list[list[int]]:
        rows = ((0.0, 0.1), (0.7, 0.2), (last, 0.1))
        # A reach of one in all: radius and sigma add up to it.
        return group_observations([observation(k, x, 1.0 - sigma, sigma) for k, (x, sigma) in enumerate(rows)])

    assert (0.7 / 0.2**2 + 1.06 / 0.1**2) / (1 / 0.2**2 + 1 / 0.1**2) < 1.0
    assert groups(1.06) == [[0, 1, 2]]
    assert (0.7 / 0.2**2 + 1.09 / 0.1**2) / (1 / 0.2**2 + 1 / 0.1**2) > 1.0
    assert groups(1.09) == [[0], [1, 2]]


def test_existence_compares_a_detector_with_one_that_invents() -> None:
    """Binomial likelihoods; inventions come in 2 % of the frames, and every detector finds at least twice that."""
    hit, miss = 0.5 / 0.02, 0.5 / 0.98
    assert existence(1, 3, 0.5) == pytest.approx(hit * miss**2 / (1 + hit * miss**2))
    assert existence(1, 1, 0.04) == pytest.approx(2 / 3)
    assert existence(1, 1, 0.0) == pytest.approx(2 / 3)
    assert existence(1, 1, 1.0) == pytest.approx(existence(1, 1, 0.95)), "and none finds all"
    assert existence(9, 9, 0.95) == pytest.approx(1.0)
    assert existence(0, 999, 0.95) == pytest.approx(0.0)


def test_a_detector_is_judged_by_what_it_found_at_least_twice() -> None:
    detections = [detection(0, A, 2), detection(1, A, 6)]
    observations = place_on_surface(detections, scene(detections=detections), times(), plates.no_matches, 0.4)
    (defect,) = find_defects(observations, scene(detections=detections), TIMES_S).defects
    assert (defect.k, defect.n) == (2, 10)
    assert defect.exists == pytest.approx(existence(2, 10, 0.2))
    once = place_on_surface(detections[:1], scene(detections=detections[:1]), times(), plates.no_matches, 0.4)
    found = find_defects(once, scene(detections=detections[:1], looked=[2, 3]), TIMES_S)
    assert [one.exists for one in found.defects] == pytest.approx([existence(1, 2, 0.5)]), "else nothing is known of it"


def test_stated_confidences_have_four_decimals() -> None:
    detections = [detection(0, A, 2), detection(1, A, 6)]
    observations = place_on_surface(detections, scene(detections=detections), times(), plates.no_matches, 0.4)
    found = find_defects(observations, scene(detections=detections), TIMES_S)
    events = event_rows(found, TIMES_S)
    (record,) = defect_records(found, events, [[]], 0)
    stated = [one.row.confidence for one in found.observations]
    assert all(0.01 < (value or 0.0) < 0.99 for value in stated), "none is cut to the bounds"
    assert record.confidence is not None
    numbers = [
        *stated,
        *(event.confidence for event in events),
        record.confidence.value,
        *record.confidence.parts.values(),
    ]
    assert [number for number in numbers if number is not None] == [round(n, 4) for n in numbers if n is not None]
    assert found.defects[0].exists != round(found.defects[0].exists, 4), "it is rounded when it is stated"


def test_a_detection_without_a_place_belongs_to_no_defect() -> None:
    detections = [detection(0, A, 2), detection(1, A, 6), detection(2, A, 4, source_index=None)]
    observations = place_on_surface(detections, scene(detections=detections), times(), plates.no_matches, 0.4)
    found = find_defects(observations, scene(detections=detections), TIMES_S)
    assert [(one.row.outcome, one.row.defect_id) for one in found.observations] == [
        ("mapped", 0),
        ("mapped", 0),
        ("unplaced", None),
    ]
