"""Sizes on surfaces of known shape: discs, ellipses, a bent sheet, a dish; and the scale that gives them a unit."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import pytest

from core.mapping.scene import Scene, face_normals
from core.mapping.surface import Surface
from core.mapping.surface_rules import place_on_surface
from core.measure.depth import depth_of
from core.measure.outline import ellipse_in, median_level, signed_distance
from core.measure.patch import SurfacePatch, cut_patch
from core.measure.scale import find_scale, join_scales
from core.measure.shape import region_of
from core.measure.sizes import measure_defects
from core.scene.detection import Detection
from core.scene.size import Measure, Scale, Size, SizeFrom, Unmeasured
from core.settings.scale import ScaleSettings
from core.surface.ply import Mesh
from tests.core.making_plates import CROP, NEAR, detection, no_matches, pixel, plate, scene, times

PLACE = (-1.0, 0.0, NEAR)
FRAMES = range(8)


def patch_of(height: Callable[[np.ndarray, np.ndarray], np.ndarray], reach: float = 1.0) -> SurfacePatch:
    """Of a height field around the origin, facing up."""
    mesh = plate((-1.5, 1.5), (-1.5, 1.5), 0.0)
    vertices = mesh.vertices.copy()
    vertices[:, 2] = height(vertices[:, 0], vertices[:, 1])
    found = cut_patch(Mesh(vertices, mesh.faces[:, ::-1]), np.array([0.0, 0.0, vertices[:, 2].max()]), reach)
    assert found is not None
    return found


def flat(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    return 0.0 * x + 0.0 * y


def test_an_ellipse_on_a_plane_has_its_axes_and_its_area() -> None:
    patch = patch_of(flat)
    x, y = patch.vertices[:, 0], patch.vertices[:, 1]
    region = region_of(patch, 1.0 - np.hypot(x / 0.6, y / 0.25))
    assert region is not None
    bends = region.bends()
    assert bends[0] * region.straight.length == pytest.approx(1.2, rel=0.02)
    assert bends[1] * region.straight.width == pytest.approx(0.5, rel=0.03)
    assert region.area == pytest.approx(np.pi * 0.6 * 0.25, rel=0.01)
    assert not region.at_rim


def test_a_bent_finding_is_measured_along_the_surface() -> None:
    """A strip around a cylinder of radius 0.5, over 120 degrees: longer along it than straight."""
    patch = patch_of(lambda x, _y: np.sqrt(np.maximum(0.25 - np.minimum(np.abs(x), 0.48) ** 2, 0.0)))
    x, y = patch.vertices[:, 0], patch.vertices[:, 1]
    half = 0.5 * np.sin(np.pi / 3)
    region = region_of(patch, np.minimum(half - np.abs(x), 0.06 - np.abs(y)))
    assert region is not None
    assert region.straight.length == pytest.approx(np.hypot(2 * half, 0.12), rel=0.02)
    assert region.bends()[0] * region.straight.length == pytest.approx(0.5 * 2 * np.pi / 3, rel=0.03)


@pytest.mark.parametrize(("amount", "expected"), [(0.1, 0.1), (-0.1, None), (0.005, None)])
def test_the_depth_of_a_dish_is_found_where_it_stands_out(amount: float, expected: float | None) -> None:
    """On a curved surface; a bump has no depth, nor what the roughness hides."""

    def dish(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        near = np.maximum(0.0, 1.0 - (x**2 + y**2) / 0.16) ** 2
        return np.asarray(-0.3 * x**2 - amount * near)

    patch = patch_of(dish)
    level = 0.4 - np.linalg.norm(patch.vertices[:, :2], axis=1)
    region = region_of(patch, level)
    assert region is not None
    found = depth_of(region, level, 0.004)
    if expected is None:
        assert found is None
    else:
        assert found is not None
        assert found.value == pytest.approx(expected, rel=0.1)


def test_a_bottom_that_shines_is_a_reflection_and_no_depth() -> None:
    """The light at the tip, reflected by a bump, is matched like a mark on the bottom of a hollow."""
    patch = patch_of(lambda x, y: -0.1 * np.maximum(0.0, 1.0 - (x**2 + y**2) / 0.16) ** 2)
    away = np.linalg.norm(patch.vertices[:, :2], axis=1)
    region = region_of(patch, 0.4 - away)
    assert region is not None
    texture = 80.0 + 20.0 * np.sin(40.0 * patch.vertices[:, 0])
    for brightness, told in (
        (texture, True),
        (texture - 40.0 * (away < 0.1), True),
        (texture + 60.0 * (away < 0.1), False),
    ):
        assert (depth_of(region, 0.4 - away, 0.004, brightness) is not None) is told


def test_a_region_that_rises_as_much_as_it_falls_has_no_depth() -> None:
    patch = patch_of(lambda x, y: -0.5 * x * np.maximum(0.0, 1.0 - (x**2 + y**2) / 0.16) ** 2)
    level = 0.4 - np.linalg.norm(patch.vertices[:, :2], axis=1)
    region = region_of(patch, level)
    assert region is not None
    assert depth_of(region, level, 0.004) is None


def test_without_a_whole_ring_no_depth_is_told() -> None:
    patch = patch_of(lambda x, y: -0.1 * np.maximum(0.0, 1.0 - (x**2 + y**2) / 0.16) ** 2)
    level = 0.4 - np.linalg.norm(patch.vertices[:, :2], axis=1)
    region = region_of(patch, level)
    assert region is not None
    assert depth_of(region, np.where(patch.vertices[:, 0] > 0.2, np.nan, level), 0.004) is None


def test_distances_to_an_outline_are_positive_inside() -> None:
    square = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]])
    found = signed_distance(np.array([[2.0, 1.0], [7.0, 8.0], [4.0, 2.0]]), square)
    assert found.tolist() == pytest.approx([1.0, -5.0, 0.0])
    ellipse = ellipse_in((0.0, 0.0, 8.0, 4.0))
    x, y = ellipse.T
    assert abs((x * np.roll(y, -1) - np.roll(x, -1) * y).sum()) / 2 == pytest.approx(np.pi * 8.0)


def test_the_median_outline_ignores_one_that_is_wrong_and_views_that_see_nothing() -> None:
    of_views = np.array([[1.0, -1.0], [1.2, np.nan], [-9.0, np.nan]])
    assert median_level(of_views, np.ones(3)).tolist() == pytest.approx([1.0, -1.0])
    assert np.isnan(median_level(np.full((2, 1), np.nan), np.ones(2))).all()


def disc(frame: int, radius: float) -> list[tuple[float, float]]:
    """Corners of a disc on the near plate as a frame shows it."""
    angle = np.linspace(0.0, 2 * np.pi, 40, endpoint=False)
    around = np.array(PLACE) + radius * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    return [(float(x), float(y)) for x, y in (pixel(point, frame) for point in around)]


def disc_detection(frame: int, radius: float, masks: bool, number: int | None = None) -> Detection:
    corners = disc(frame, radius)
    (x1, y1), (x2, y2) = np.min(corners, axis=0), np.max(corners, axis=0)
    size = np.array([CROP.source_width, CROP.source_height] * 2)
    box = (np.array([x1, y1, x2, y2]) + np.array([CROP.x0, CROP.y0] * 2)) / size
    made = detection(frame if number is None else number, PLACE, frame, polygon_px=corners if masks else None)
    return replace(made, box=tuple(box.tolist()))


def measured(found: Sequence[Detection], where: Scene | None = None) -> tuple[Size, dict[int, Size]]:
    where = where or scene(FRAMES, found)
    seen = place_on_surface(found, where, times(), no_matches, 0.4)
    mapped = [one for one in seen if one.row.outcome == "mapped"]
    sizes = measure_defects([mapped], [np.array(PLACE)], {one.id: one for one in found}, where)
    return sizes.defects[0], dict(sizes.detections)


@pytest.mark.parametrize("masks", [True, False])
def test_a_disc_has_its_diameter_by_masks_and_by_boxes(masks: bool) -> None:
    size, single = measured([disc_detection(frame, 0.3, masks) for frame in FRAMES])
    assert size.size_from == (SizeFrom.MASK if masks else SizeFrom.BOX)
    assert size.length is not None
    assert size.width is not None
    assert size.area is not None
    assert size.depth is None
    assert size.length.value == pytest.approx(0.6, rel=0.05)
    assert size.width.value == pytest.approx(0.6, rel=0.05)
    assert size.area.value == pytest.approx(np.pi * 0.09, rel=0.08)
    assert abs(size.length.value - 0.6) < 2 * size.length.sigma
    assert single.keys() == set(FRAMES)


@pytest.mark.parametrize("shines", [False, True])
def test_the_depth_of_a_finding_minds_the_colours_of_the_surface(shines: bool) -> None:
    found = [disc_detection(frame, 0.4, masks=True) for frame in FRAMES]
    where = scene(FRAMES, found)
    away = np.linalg.norm(where.mesh.vertices - np.array(PLACE), axis=1)
    towards = np.sign(where.views.centers[0][2] - NEAR)
    vertices = where.mesh.vertices.copy()
    vertices[:, 2] -= towards * 0.15 * np.maximum(0.0, 1.0 - (away / 0.4) ** 2) ** 2
    colors = np.full((len(vertices), 3), 90, np.uint8)
    colors[away < 0.15] = 250 if shines else 60
    mesh = replace(where.mesh, vertices=vertices, colors=colors)
    where = replace(where, mesh=mesh, surface=Surface(mesh.vertices, mesh.faces), face_normals=face_normals(mesh))
    size, _ = measured(found, where)
    assert size.length is not None
    if shines:
        assert size.depth is None
    else:
        assert size.depth is not None
        assert size.depth.value == pytest.approx(0.15, rel=0.25)


def test_masks_count_before_boxes_and_more_views_make_it_surer() -> None:
    wrong = disc_detection(1, 0.6, masks=False)
    size, _ = measured([disc_detection(0, 0.3, masks=True), wrong])
    assert size.size_from == SizeFrom.MASK
    assert size.length is not None
    assert size.length.value == pytest.approx(0.6, rel=0.06)
    many, _ = measured([disc_detection(frame, 0.3, masks=True) for frame in FRAMES])
    assert many.length is not None
    assert many.length.outline < size.length.outline


def test_one_wrong_outline_of_many_moves_nothing() -> None:
    found = [disc_detection(frame, 0.6 if frame == 3 else 0.3, masks=True) for frame in FRAMES]
    size, single = measured(found)
    assert size.length is not None
    assert size.length.value == pytest.approx(0.6, rel=0.06)
    assert single[3].length is not None
    assert single[3].length.value == pytest.approx(1.2, rel=0.1)


def test_a_finding_without_surface_or_view_says_why() -> None:
    size, _ = measured([disc_detection(0, 0.3, masks=True)], scene(FRAMES, mesh=plate((2.0, 3.0), (2.0, 3.0), 9.0)))
    assert (size.reason, size.length) == (Unmeasured.NO_VIEW, None)
    found = [disc_detection(0, 0.3, masks=True)]
    seen = place_on_surface(found, scene(FRAMES, found), times(), no_matches, 0.4)
    bare = scene(FRAMES, found, mesh=plate((2.0, 3.0), (2.0, 3.0), 9.0))
    lost = measure_defects([seen], [np.array(PLACE)], {0: found[0]}, bare).defects[0]
    assert lost.reason == Unmeasured.NO_SURFACE
    assert lost.columns().length_unit is None


def told(**changes: object) -> ScaleSettings:
    """1.0 units on the near plate, 12 mm long."""
    ends = [pixel((x, 0.0, NEAR), 2) + np.array([CROP.x0, CROP.y0]) for x in (-1.5, -0.5)]
    values = {"points": tuple(float(v) for end in ends for v in end), "length_mm": 12.0, "time_s": 0.2, **changes}
    return ScaleSettings(**values)


def test_a_known_length_between_two_pixels_gives_the_scale() -> None:
    found = find_scale(told(), scene(FRAMES), times())
    assert found.scale is not None
    assert found.scale.value == pytest.approx(12.0, rel=0.01)
    assert found.scale.source == "points"
    assert 0.01 < found.scale.share < 0.15
    assert not found.flags
    unsure = find_scale(told(length_sigma_mm=6.0), scene(FRAMES), times()).scale
    assert unsure is not None
    assert unsure.share == pytest.approx(0.5, rel=0.05)


@pytest.mark.parametrize(
    ("changes", "says"),
    [({"time_s": 0.93}, "0.7000 s"), ({"points": (1.0, 1.0, 2.0, 1.0)}, "no surface"), ({"video": 4}, "registered")],
)
def test_a_scale_that_cannot_be_used_says_why(changes: dict[str, object], says: str) -> None:
    found = find_scale(told(**changes), scene(FRAMES, mesh=plate((-3.0, 0.0), (-0.5, 0.5), NEAR)), times())
    assert found.scale is None
    assert [flag.code for flag in found.flags] == ["scale_unknown"]
    assert says in found.flags[0].where


def test_a_scale_is_told_whole() -> None:
    for changes in ({"length_mm": None}, {"points": (1.0, 2.0, 1.0, 2.0)}):
        with pytest.raises(ValueError, match=r"scale\.points"):
            told(**changes)
    assert find_scale(ScaleSettings(), scene(FRAMES), times()).scale is None


def test_scales_that_agree_are_joined_and_others_are_named() -> None:
    near = join_scales([Scale(10.0, 0.3, "points"), Scale(10.4, 0.4, "row")])
    assert near.scale is not None
    assert near.scale.value == pytest.approx((10 / 0.09 + 10.4 / 0.16) / (1 / 0.09 + 1 / 0.16))
    assert near.scale.sigma == pytest.approx(0.24)
    assert near.scale.source == "points+row"
    assert not near.flags
    far = join_scales([Scale(10.0, 0.3, "points"), Scale(14.0, 0.4, "row")])
    assert [flag.code for flag in far.flags] == ["scale_disagrees"]
    assert far.flags[0].value == pytest.approx(8.0)
    assert far.scale is not None
    assert far.scale.sigma > 1.5, "the scatter counts"


def test_a_scale_makes_millimetres_and_adds_its_own_uncertainty() -> None:
    size = Size(length=Measure(0.5, 0.03, 0.0, 0.04), area=Measure(0.2, 0.01, 0.0, 0.0), size_from=SizeFrom.MASK)
    scaled = size.scaled(Scale(10.0, 0.5, "points"))
    columns = scaled.columns()
    assert columns.length == 5.0
    assert columns.area == pytest.approx(20.0)
    assert columns.length_unit == "mm"
    assert columns.length_sigma == pytest.approx(np.hypot(0.5, 0.25))
    assert columns.area_sigma == pytest.approx(np.hypot(1.0, 2.0))
    assert Size.from_dict(scaled.to_dict()) == scaled
