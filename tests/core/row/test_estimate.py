"""A row is found on true surfaces of three blades and more, and is unknown on everything else."""

from __future__ import annotations

import numpy as np
import pytest

from core.row.blades import fit_sheet, seen_blades
from core.row.estimate import MIN_CONTRAST, estimate_row, refused
from core.row.model import BladeRow, NoRow, RowStatus, UnknownRow
from core.row.overlap import Hypothesis
from core.row.sample import sample_surface, thinned
from core.row.turn import Axis
from core.surface.ply import Mesh
from tests.core.making_blades import PITCH_RAD, blade_of, blades, walk

TRUE_AXIS = Axis(np.array([0.0, 0.0, 1.0]), np.zeros(3))
PITCH_WITHIN = 0.005
AXIS_WITHIN_DEG = 0.5
FOOT_WITHIN_MM = 1.5
VIEWS = 6
FEW_VIEWS = 4


@pytest.fixture(scope="module")
def three() -> BladeRow:
    found = estimate_row(blades(3), walk(VIEWS), seed=0)
    assert isinstance(found, BladeRow)
    return found


def test_axis_and_pitch_of_three_blades(three: BladeRow) -> None:
    assert three.pitch_rad == pytest.approx(PITCH_RAD, rel=PITCH_WITHIN)
    assert abs(three.axis.direction[2]) > np.cos(np.radians(AXIS_WITHIN_DEG))
    along = three.axis.foot[2] / three.axis.direction[2]
    assert np.linalg.norm(three.axis.foot - along * three.axis.direction) < FOOT_WITHIN_MM


def test_three_blades_are_numbered_from_the_one_seen_first(three: BladeRow) -> None:
    assert sorted(three.numbers.values()) == [1, 2, 3]
    assert np.abs(np.diff(three.phases)) == pytest.approx([PITCH_RAD, PITCH_RAD], rel=PITCH_WITHIN)


def test_the_number_of_blades_is_an_interval_that_holds_the_true_one(three: BladeRow) -> None:
    low, high = three.count
    assert low <= 64 <= high
    assert low < high
    assert three.status == RowStatus.ESTIMATED


def test_root_and_tip_of_three_blades(three: BladeRow) -> None:
    assert (three.root_radius, three.tip_radius) == pytest.approx((150.0, 198.0), abs=2.0)


def test_no_part_is_seen_by_more_views_than_by_fewer(three: BladeRow) -> None:
    assert [one.blade for one in three.coverage] == [1, 2, 3]
    for one in three.coverage:
        assert 1 >= one.by_views[2] >= one.by_views[3] >= one.by_views[5] >= 0
        assert one.views > 0
    assert max(one.by_views[2] for one in three.coverage) > 0.15


def test_the_row_as_json_says_what_is_not_known(three: BladeRow) -> None:
    row = three.to_dict()
    assert row["status"] == "estimated"
    assert row["edges"] == {"a": "unknown", "b": "unknown"}
    assert row["zero_blade"] is None
    assert [blade["number"] for blade in row["blades"]] == [1, 2, 3]


@pytest.mark.parametrize("count", [3, 5])
def test_every_point_gets_its_blade(count: int) -> None:
    mesh = blades(count)
    points = thinned(sample_surface(mesh, 0), 4000)
    sheet = fit_sheet(points, Hypothesis(TRUE_AXIS, PITCH_RAD))
    index = sheet.blade(mesh.vertices)
    off = index - blade_of(np.arange(len(mesh.vertices)))
    values, counts = np.unique(off, return_counts=True)
    assert counts.max() / counts.sum() > 0.99
    assert len(seen_blades(sheet, points)) == count
    assert values[counts.argmax()] == seen_blades(sheet, points).min()


@pytest.mark.parametrize(
    ("mesh", "reasons"),
    [
        (blades(2), {UnknownRow.TOO_FEW_BLADES, UnknownRow.NO_REPETITION}),
        (blades(1), {UnknownRow.NO_REPETITION}),
        (blades(0, hub=True), {UnknownRow.NO_REPETITION}),
        (Mesh(np.zeros((0, 3))), {UnknownRow.NO_SURFACE}),
    ],
    ids=["two blades", "one blade", "hub", "nothing"],
)
def test_anything_else_is_unknown(mesh: Mesh, reasons: set[UnknownRow]) -> None:
    found = estimate_row(mesh, walk(FEW_VIEWS), seed=0)
    assert isinstance(found, NoRow)
    assert found.reason in reasons
    assert found.to_dict()["status"] == "unknown"


def test_two_views_tell_no_row() -> None:
    found = estimate_row(blades(3), walk(2), seed=0)
    assert isinstance(found, NoRow)
    assert found.reason == UnknownRow.TOO_FEW_VIEWS


def test_two_blades_are_too_few_though_they_fit_each_other() -> None:
    points = thinned(sample_surface(blades(2), 0), 3000)
    found = refused(points, Hypothesis(TRUE_AXIS, PITCH_RAD))
    assert found is not None
    assert found.reason == UnknownRow.TOO_FEW_BLADES
    assert found.contrast is not None
    assert found.contrast > MIN_CONTRAST
