"""A row is found on true surfaces of three blades and more, and is unknown on everything else."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest

from bench.scenes.blades import surface_point
from core.row import estimate
from core.row.blades import fit_sheet, seen_blades
from core.row.estimate import MIN_CONTRAST, Apart, estimate_row, told_apart, told_numbers
from core.row.files import read_blades, read_found, write_blades, write_found
from core.row.map import row_map
from core.row.model import BladeRow, EdgeName, NoRow, RowStatus, UnknownRow
from core.row.overlap import Hypothesis, contrast
from core.row.places import normals_at, on_row
from core.row.sample import sample_surface, smoothed, thinned
from core.row.section import _sides
from core.row.tables import scale_of_row
from core.row.turn import Axis
from core.scene.on_row import Side
from core.settings.row import RowSettings
from core.surface.ply import Mesh
from tests.core.making_blades import PITCH_RAD, SCENE, blade_of, blades, walk
from tests.core.making_row_surfaces import read_surface

pytestmark = pytest.mark.slow

TRUE_AXIS = Axis(np.array([0.0, 0.0, 1.0]), np.zeros(3))
PITCH_WITHIN = 0.005
AXIS_WITHIN_DEG = 0.5
FOOT_WITHIN_MM = 1.5
VIEWS = 6
FEW_VIEWS = 4
ROUGH_MM = 0.4


@pytest.fixture(scope="module")
def three() -> BladeRow:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(estimate, "FIT_POINTS", 5000)  # half of them, which is quicker
        found = estimate_row(blades(3), walk(VIEWS), seed=0)
    assert isinstance(found, BladeRow)
    return found


@pytest.fixture
def few_points(monkeypatch: pytest.MonkeyPatch) -> None:
    """Rows are fitted to fewer points of a surface: quicker."""
    monkeypatch.setattr(estimate, "FIT_POINTS", 3000)


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
    assert [blade["seen"] for blade in row["blades"]] == [1, 2, 3]


def test_a_row_is_the_same_after_it_was_written(three: BladeRow, tmp_path: Path) -> None:
    write_blades(tmp_path, three)
    again = read_blades(tmp_path)
    assert isinstance(again, BladeRow)
    assert again.to_dict() == three.to_dict()
    points = blades(3).vertices[::50]
    assert np.array_equal(again.sheet.position(points), three.sheet.position(points))
    assert again.section == three.section
    for found in (Hypothesis(TRUE_AXIS, PITCH_RAD), NoRow(UnknownRow.NO_SURFACE)):
        write_found(tmp_path, found)
        assert repr(read_found(tmp_path)) == repr(found)


def test_the_side_that_bends_out_is_convex(three: BladeRow) -> None:
    """Of the scene's blades the upper side is convex; it faces growing angles about the scene's axis."""
    way = 1 if three.axis.direction[2] > 0 else -1
    assert three.section.sides == {way: Side.CONVEX, -way: Side.CONCAVE}
    assert all(three.section.edges.values())


def test_a_side_is_unknown_where_both_look_alike() -> None:
    assert _sides({1: 0.1, -1: 0.1}) == {1: Side.UNKNOWN, -1: Side.UNKNOWN}
    assert _sides({1: 0.1, -1: None}) == {1: Side.CONVEX, -1: Side.UNKNOWN}
    assert _sides({1: None, -1: -0.1}) == {1: Side.CONVEX, -1: Side.CONCAVE}
    assert _sides({1: 0.001, -1: None}) == {1: Side.UNKNOWN, -1: Side.UNKNOWN}


@pytest.mark.parametrize("side", [1, -1])
def test_places_of_every_side_have_their_span_chord_and_edge(three: BladeRow, side: int) -> None:
    spans, chords = np.meshgrid([0.2, 0.5, 0.8], [0.0, 0.08, 0.3, 0.6, 0.9])
    mesh = blades(3)
    true = list(zip(spans.ravel(), chords.ravel(), strict=True))
    places = np.array([surface_point(SCENE, 1, span, chord, side) for span, chord in true])
    lower = three.axis.direction[2] > 0  # the leading edge is the one at lower z
    told = replace(three, edge_a=EdgeName.LEADING if lower else EdgeName.TRAILING)
    found = on_row(told, places, normals_at(mesh, places), [None] * len(places))
    assert {one.blade for one in found} == {2}
    for one, (span, chord) in zip(found, true, strict=True):
        assert one.columns.span == pytest.approx(span, abs=0.03)
        assert one.columns.chord == pytest.approx(chord, abs=0.08)
        if 0.3 <= chord <= 0.6:
            assert one.columns.side == (Side.CONVEX if side > 0 else Side.CONCAVE)
        if chord == 0.0:
            assert one.columns.side == Side.LEADING_EDGE
            assert one.columns.edge_distance == pytest.approx(0.0, abs=2.5)
    unnamed = on_row(three, places, normals_at(mesh, places), [None] * len(places))
    assert all(one.columns.chord is None for one in unnamed)
    assert Side.LEADING_EDGE not in {one.columns.side for one in unnamed}


@pytest.mark.parametrize(
    ("options", "numbers"),
    [
        ({}, {4: 1, 5: 2, 6: 3}),
        ({"direction": "reversed"}, {4: 3, 5: 2, 6: 1}),
        ({"count": 64, "zero_blade": 2}, {4: 64, 5: 1, 6: 2}),
        ({"count": 64, "zero_blade": 2, "direction": "reversed"}, {4: 2, 5: 1, 6: 64}),
        ({"count": 64, "zero_blade": -3}, {4: 5, 5: 6, 6: 7}),
    ],
)
def test_numbers_go_round_as_the_user_counts(options: dict[str, Any], numbers: dict[int, int]) -> None:
    assert told_numbers({4: 1, 5: 2, 6: 3}, RowSettings(**options)) == numbers


def test_a_radius_that_is_told_gives_the_scale(three: BladeRow) -> None:
    scale = scale_of_row(three, RowSettings(radius_mm=2 * three.root_radius))
    assert scale is not None
    assert scale.value == pytest.approx(2.0)
    assert 0.03 < scale.share < 0.04, "the pitch is known to 3 %, and radius and pitch trade"
    assert scale_of_row(three, RowSettings()) is None
    place = on_row(three, blades(3).vertices[2000:2001], np.array([[0.0, 1.0, 0.0]]), [0.1])[0]
    distance = place.columns.root_distance
    assert distance is not None
    assert place.scaled(scale).columns.root_distance == pytest.approx(2.0 * distance, abs=1e-5)


def test_the_map_shows_every_blade_and_finding_and_no_markup_of_a_label(three: BladeRow) -> None:
    place = {"blade": 2, "span": 0.5, "side": "convex", "from_edge_a": 0.2}
    findings = [{"defect": 7, "label": "<script>", **place}, {"defect": 8, "label": "a", **place, "blade": None}]
    drawn = row_map({**three.to_dict(), "findings": findings})
    root = ElementTree.fromstring(drawn)
    texts = [one.text for one in root.iter("{http://www.w3.org/2000/svg}text")]
    assert {"1", "2", "3", "D7"} <= set(texts)
    assert "D8" not in texts
    assert any("on no blade: 1" in str(text) for text in texts)
    assert "<script>" not in drawn
    assert "unknown" in row_map({**NoRow(UnknownRow.NO_REPETITION).to_dict(), "findings": []})


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
    ("name", "reasons"),
    [
        ("two-blades", {UnknownRow.TOO_FEW_BLADES, UnknownRow.NO_REPETITION}),
        ("one-blade", {UnknownRow.NO_REPETITION}),
        ("hub", {UnknownRow.NO_REPETITION}),
    ],
)
def test_what_cameras_saw_of_anything_else_is_unknown(name: str, reasons: set[UnknownRow], few_points: None) -> None:
    found = estimate_row(*read_surface(name), seed=0)
    assert isinstance(found, NoRow)
    assert found.reason in reasons
    assert found.to_dict()["status"] == "unknown"


def test_what_cameras_saw_of_three_blades_and_the_hub_between_is_a_row(few_points: None) -> None:
    mesh, views = read_surface("three-blades")
    found = estimate_row(mesh, views, seed=0)
    assert isinstance(found, BladeRow)
    assert found.pitch_rad == pytest.approx(PITCH_RAD, rel=0.02)
    assert sorted(found.numbers.values()) == [1, 2, 3]


def test_without_a_surface_no_row_is_known() -> None:
    found = estimate_row(Mesh(np.zeros((0, 3))), walk(FEW_VIEWS), seed=0)
    assert isinstance(found, NoRow)
    assert found.reason == UnknownRow.NO_SURFACE


def test_a_hub_does_not_hide_how_blades_repeat() -> None:
    points = thinned(sample_surface(blades(3, hub=True), 0), 4000)
    row = Hypothesis(TRUE_AXIS, PITCH_RAD)
    assert isinstance(told_apart(points, row), Apart)
    alone = thinned(sample_surface(blades(3), 0), 4000)
    assert contrast(points, row) == pytest.approx(contrast(alone, row), abs=0.05)
    hub = thinned(sample_surface(blades(0, hub=True), 0), 1000)
    assert contrast(hub, row) == 0.0


def test_two_views_tell_no_row() -> None:
    found = estimate_row(blades(3), walk(2), seed=0)
    assert isinstance(found, NoRow)
    assert found.reason == UnknownRow.TOO_FEW_VIEWS


def test_two_blades_are_too_few_though_they_fit_each_other() -> None:
    points = thinned(sample_surface(blades(2), 0), 3000)
    found = told_apart(points, Hypothesis(TRUE_AXIS, PITCH_RAD))
    assert isinstance(found, NoRow)
    assert found.reason == UnknownRow.TOO_FEW_BLADES
    assert found.contrast is not None
    assert found.contrast > MIN_CONTRAST


def test_which_way_a_place_looks_is_asked_of_what_lies_about_it() -> None:
    """A rough patch: its faces look anywhere, the surface about it up."""
    side = np.linspace(-1.0, 1.0, 41)
    x, y = np.meshgrid(side, side)
    rng = np.random.default_rng(0)
    z = np.where(np.hypot(x, y) < 0.2, rng.normal(scale=0.1, size=x.shape), 0.0)
    corner = (np.arange(40)[:, None] * 41 + np.arange(40)).ravel()
    faces = np.concatenate(
        [np.stack([corner, corner + 1, corner + 41], 1), np.stack([corner + 1, corner + 42, corner + 41], 1)]
    )
    mesh = Mesh(np.stack([x, y, z], -1).reshape(-1, 3), faces.astype(np.int32))
    places = np.column_stack([rng.uniform(-0.1, 0.1, (20, 2)), np.zeros(20)])
    alone, about = normals_at(mesh, places), normals_at(smoothed(mesh, 0.15), places)
    assert about[:, 2].min() > 0.9
    assert alone[:, 2].min() < 0.7
    back = Mesh(
        np.concatenate([mesh.vertices, mesh.vertices - (0, 0, 0.01)]),
        np.concatenate([faces, faces[:, ::-1] + 41 * 41]).astype(np.int32),
    )
    both = smoothed(back, 0.15)
    apart = both.vertices[: 41 * 41] - both.vertices[41 * 41 :]
    assert np.allclose(apart, (0.0, 0.0, 0.01)), "neither side draws the other"
    assert smoothed(mesh, 0.0) is mesh


def test_a_rough_surface_shows_its_row() -> None:
    """Faces that look anywhere do not fit each other after a turn, though the blades lie on each other."""
    true = blades(4)
    off = np.random.default_rng(0).normal(scale=ROUGH_MM, size=true.vertices.shape)
    rough = replace(true, vertices=true.vertices + off)
    drawn = thinned(sample_surface(rough, 0), 5000)
    assert contrast(drawn, Hypothesis(TRUE_AXIS, PITCH_RAD)) < MIN_CONTRAST, "it does not show it by itself"
    found = estimate_row(rough, walk(VIEWS), seed=0)
    assert isinstance(found, BladeRow)
    assert found.pitch_rad == pytest.approx(PITCH_RAD, rel=0.01)
    assert sorted(found.numbers.values()) == [1, 2, 3, 4]
    places = true.vertices[::50]
    index = np.round(found.sheet.position(places))
    assert len(np.unique(index - blade_of(np.arange(len(true.vertices)))[::50])) == 1
