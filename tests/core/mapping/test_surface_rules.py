"""Detections cast onto two plates: which surface is meant, what other frames say, and the fallback methods."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from core.mapping.observations import Observation
from core.mapping.surface_rules import place_on_surface
from core.scene.detection import Detection
from tests.core import making_plates as plates
from tests.core.making_plates import FAR, NEAR, detection, scene, times

FRAMES = range(10)
ON_NEAR = (-0.8, 0.2, NEAR)
ON_EDGE = (0.0, 0.3, NEAR)


def placed(detections: list[Detection], **more: object) -> list[Observation]:
    scale = more.get("scale", 1.0)
    assert isinstance(scale, float)
    made = scene(detections=detections, **more)  # type: ignore[arg-type]
    return place_on_surface(detections, made, times(), plates.no_matches, 0.4)


def xyz(one: Observation) -> np.ndarray:
    return np.array([one.row.x, one.row.y, one.row.z], np.float64)


def seen_in(place: tuple[float, float, float], frames: range = FRAMES, **more: object) -> list[Detection]:
    return [detection(i, place, frame, **more) for i, frame in enumerate(frames)]  # type: ignore[arg-type]


@pytest.mark.parametrize("scale", [1.0, 1000.0, 0.001])
def test_a_place_on_a_plate_is_found_in_any_unit(scale: float) -> None:
    for one in placed(seen_in(ON_NEAR), scale=scale):
        assert (one.row.outcome, one.row.rung, one.row.reason) == ("mapped", "surface", None)
        assert xyz(one) / scale == pytest.approx(ON_NEAR, abs=0.02)
        assert one.normal == pytest.approx((0, 0, -1), abs=1e-6)
        # Sixteen pixels across at four units, less the shrinking of the ellipse.
        assert one.radius / scale == pytest.approx(8 * 0.9 * NEAR / plates.FOCAL, rel=0.15)
        assert one.sigma is not None
        assert 0.0 < one.sigma / scale < 0.1


def test_over_an_edge_the_nearer_surface_is_meant() -> None:
    for one in placed(seen_in(ON_EDGE)):
        assert one.row.z == pytest.approx(NEAR, abs=1e-3)
        assert one.row.x is not None
        assert -0.2 < one.row.x <= 0.0
        assert one.parts is not None
        assert 0.3 < one.parts.share < 0.7


def test_a_sheet_that_depth_maps_see_through_is_not_meant() -> None:
    sheet = plates.plate((-0.8, -0.7), (-0.2, 0.6), 3.6)
    detections = seen_in(ON_NEAR)
    mesh = plates.plates(sheet)
    unaware = placed(detections, mesh=mesh)
    assert any(one.row.z < 3.7 for one in unaware if one.row.z is not None), "the sheet lies in the boxes"
    depth = plates.depth_maps_of(plates.plates(), [0, 4, 8])
    for one in placed(detections, mesh=mesh, depth=depth):
        assert one.row.z == pytest.approx(NEAR, abs=1e-3)
        assert one.parts is not None
        assert one.parts.depth == pytest.approx(1.0)


def test_other_frames_support_or_contradict() -> None:
    supported = seen_in(ON_NEAR, range(8))
    lonely = detection(8, (-1.5, -0.5, NEAR), 4)
    found = placed([*supported, lonely])
    parts = found[0].parts
    assert parts is not None
    assert (parts.visible, parts.support, parts.same_label) == (9, 7, 7)
    assert (found[8].row.outcome, found[8].row.reason) == ("approximate", "contradicted")
    assert found[8].row.rung == "surface"
    # Where the detector saw only the frames with boxes, nothing speaks against it.
    quiet = placed([*supported, lonely], looked=[4])
    assert quiet[8].row.outcome == "mapped"
    assert quiet[8].parts is not None
    assert quiet[8].parts.visible == 0


def test_a_box_of_another_label_supports_less() -> None:
    detections = [detection(i, ON_NEAR, i, label="dent" if i < 5 else "nick") for i in FRAMES]
    parts = placed(detections)[0].parts
    assert parts is not None
    assert (parts.support, parts.same_label) == (9, 4)


def test_without_surface_the_depth_map_then_the_sparse_points_give_an_estimate() -> None:
    hole = plates.plate((2.0, 3.0), (-2.0, 2.0), NEAR)
    one = [detection(0, ON_NEAR, 3)]
    depth = plates.depth_maps_of(plates.plates(), [3])
    by_depth = placed(one, mesh=hole, depth=depth)[0]
    assert len(by_depth.points) == len(by_depth.point_ids) == 0, "no surface was met"
    assert (by_depth.row.outcome, by_depth.row.reason, by_depth.row.rung) == ("approximate", "off_surface", "depth")
    assert xyz(by_depth) == pytest.approx(ON_NEAR, abs=0.05)
    points = np.array(ON_NEAR) + np.array([[0.05, 0, 0], [-0.05, 0.02, 0], [0, -0.05, 0.01], [0, 0, FAR - NEAR]])
    xy = np.array([plates.pixel(point, 3) for point in points])
    by_points = placed(one, mesh=hole, sparse={3: (xy, points)})[0]
    assert (by_points.row.outcome, by_points.row.rung) == ("approximate", "sparse")
    assert xyz(by_points) == pytest.approx(ON_NEAR, abs=0.05), "the point behind does not count"
    nothing = placed(one, mesh=hole)[0]
    assert (nothing.row.outcome, nothing.row.reason, nothing.row.x) == ("unplaced", "off_surface", None)


def test_a_blade_without_a_surface_is_not_taken_for_the_next_one() -> None:
    far = plates.plate((-3.0, 3.0), (-2.0, 2.0), FAR)
    one = detection(0, ON_NEAR, 3)
    points = np.array(ON_NEAR) + np.array([[0.05, 0, 0], [-0.05, 0.02, 0], [0, -0.05, 0.01]])
    sparse = {3: (np.array([plates.pixel(point, 3) for point in points]), points)}
    unaware = placed([one], mesh=far, looked=[3])[0]
    assert unaware.row.outcome == "mapped"
    assert unaware.row.z == pytest.approx(FAR, abs=1e-3)
    found = placed([one], mesh=far, looked=[3], sparse=sparse)[0]
    assert (found.row.outcome, found.row.reason, found.row.rung) == ("approximate", "off_surface", "sparse")
    assert xyz(found) == pytest.approx(ON_NEAR, abs=0.05)
    # Frames that agree on the far place outvote a few points, which may be wrong.
    seen_behind = seen_in((ON_NEAR[0] * FAR / NEAR, ON_NEAR[1] * FAR / NEAR, FAR))
    outvoted = placed(seen_behind, mesh=far, sparse=sparse)
    assert [row.row.outcome for row in outvoted] == ["mapped"] * len(seen_behind)
    # So do depth maps that show it.
    shown = placed([one], mesh=far, looked=[3], sparse=sparse, depth=plates.depth_maps_of(far, [2, 3, 4]))[0]
    assert shown.row.outcome == "mapped"
    assert shown.row.z == pytest.approx(FAR, abs=1e-3)


def test_sparse_points_at_two_depths_give_one_of_them_and_never_nothing() -> None:
    """The quartile of few depths lies between two of them; nothing is near it."""
    hole = plates.plate((2.0, 3.0), (-2.0, 2.0), NEAR)
    points = np.array(ON_NEAR) + np.array([[0, 0, -2.0], [0, 0, 0], [0.01, 0, 2.0]])
    xy = np.array([plates.pixel(ON_NEAR, 3)] * 3)
    one = placed([detection(0, ON_NEAR, 3)], mesh=hole, sparse={3: (xy, points)})[0]
    assert (one.row.outcome, one.row.rung) == ("approximate", "sparse")
    assert xyz(one) == pytest.approx(points[0])


def test_the_back_of_a_surface_is_no_place() -> None:
    near = plates.plate((-3.0, 0.0), (-2.0, 2.0), NEAR)
    back = type(near)(near.vertices, np.ascontiguousarray(near.faces[:, ::-1]))
    found = placed([detection(0, ON_NEAR, 3)], mesh=back)[0]
    assert (found.row.outcome, found.row.reason) == ("unplaced", "occluded")


def test_a_stray_sheet_that_shows_its_back_is_seen_through() -> None:
    sheet = plates.plate((-1.2, -0.4), (-0.2, 0.6), 3.5)
    backs = [
        type(sheet)(sheet.vertices + np.array([0, 0, dz]), np.ascontiguousarray(sheet.faces[:, ::-1]))
        for dz in (0, 0.2)
    ]
    for one in placed(seen_in(ON_NEAR), mesh=plates.plates(*backs)):
        assert one.row.outcome == "mapped"
        assert xyz(one) == pytest.approx(ON_NEAR, abs=0.02)


def test_a_blade_that_came_out_turned_is_a_place_where_views_and_depths_say_so() -> None:
    near = plates.plate((-3.0, 0.0), (-2.0, 2.0), NEAR)
    turned = type(near)(near.vertices, np.ascontiguousarray(near.faces[:, ::-1]))
    mesh = plates.joined([turned, plates.plate((-4.0, 4.0), (-3.0, 3.0), FAR)])
    detections = seen_in(ON_NEAR)
    for one in placed(detections, mesh=mesh):
        assert one.row.z == pytest.approx(FAR, abs=1e-3), "unaware of what was seen"
    depth = plates.depth_maps_of(plates.plates(), [0, 4, 8])
    for one in placed(detections, mesh=mesh, depth=depth):
        assert (one.row.outcome, one.row.rung) == ("mapped", "surface")
        assert xyz(one) == pytest.approx(ON_NEAR, abs=0.02)
        assert one.normal == pytest.approx((0, 0, -1), abs=1e-6)
        assert one.parts is not None
        assert one.parts.support == len(detections) - 1


def test_a_normal_does_not_depend_on_which_way_its_faces_are_turned() -> None:
    """A roof, its ridge under the box; the half that the camera is nearer to came out turned."""
    flat = plates.plate((-1.6, 0.0), (-0.6, 1.0), NEAR)
    away = np.abs(flat.vertices[:, :1] - ON_NEAR[0]) * [0.0, 0.0, 0.5]
    roof = replace(flat, vertices=flat.vertices + away)
    right = roof.vertices[roof.faces].mean(axis=1)[:, 0] > ON_NEAR[0]
    half = replace(roof, faces=np.where(right[:, None], roof.faces[:, ::-1], roof.faces))
    depth = plates.depth_maps_of(roof, [6, 8, 9])
    whole, mixed = (placed([detection(0, ON_NEAR, 8)], mesh=mesh, depth=depth)[0] for mesh in (roof, half))
    assert mixed.parts is not None
    assert mixed.parts.share == pytest.approx(1.0), "both halves are one patch"
    assert mixed.normal == pytest.approx(whole.normal, abs=1e-6)
    assert whole.normal[2] < -0.9


def test_a_frame_without_pose_is_placed_between_its_neighbours_or_not_at_all() -> None:
    frames = [0, 1, 2, 3, 5, 6, 7, 8]
    between = placed([detection(0, ON_NEAR, 4)], frames=frames)[0]
    assert (between.row.outcome, between.row.reason) == ("approximate", "frame_not_registered")
    assert between.row.rung == "interpolated"
    assert xyz(between) == pytest.approx(ON_NEAR, abs=0.02)
    for frame, registered in ((5, [0, 1, 2, 3, 10, 11]), (9, [0, 1, 2, 3, 4])):  # 0.5 s to one side; none on one side
        far = placed([detection(0, ON_NEAR, frame)], frames=registered)[0]
        assert (far.row.outcome, far.row.reason) == ("unplaced", "frame_not_registered")


def test_matches_carry_a_box_to_a_registered_frame() -> None:
    frames = [0, 1, 2, 3]
    one = detection(0, ON_NEAR, 9)
    rng = np.random.default_rng(0)
    points = np.array(ON_NEAR) + np.column_stack([rng.uniform(-0.3, 0.3, (30, 2)), np.zeros(30)])
    own = np.array([plates.pixel(point, 9) for point in points])
    other = np.array([plates.pixel(point, 3) for point in points])
    made = scene(frames, [one])
    found = place_on_surface([one], made, times(), lambda _: [(3, own, other)], 0.4)[0]
    assert (found.row.outcome, found.row.rung, found.row.reason) == (
        "approximate",
        "propagated",
        "frame_not_registered",
    )
    assert xyz(found) == pytest.approx(ON_NEAR, abs=0.05)


def test_a_mask_shows_only_what_it_covers() -> None:
    center = plates.pixel(ON_EDGE, 3)
    right = [(center[0] + 2, center[1] - 6), (center[0] + 8, center[1] - 6), (center[0] + 8, center[1] + 6)]
    masked = placed([detection(0, ON_EDGE, 3, polygon_px=[(x, y) for x, y in right])])[0]
    assert masked.row.z == pytest.approx(FAR, abs=1e-3)
    boxed = placed([detection(0, ON_EDGE, 3)])[0]
    assert boxed.row.z == pytest.approx(NEAR, abs=1e-3)


def test_what_has_no_frame_or_lies_outside_says_so() -> None:
    outside = detection(0, ON_NEAR, 3)
    outside = type(outside)(**{**outside.__dict__, "box": (0.0, 0.0, 0.02, 0.02)})
    nowhere = type(outside)(**{**outside.__dict__, "id": 1, "source_index": None})
    later = type(outside)(**{**detection(2, ON_NEAR, 3).__dict__, "source_index": 500, "time_s": 50.0})
    rows = [one.row for one in placed([outside, nowhere, later])]
    assert [row.reason for row in rows] == ["outside_roi", "no_frame", "no_registered_view"]
    assert {row.outcome for row in rows} == {"unplaced"}
