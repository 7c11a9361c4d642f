from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

import pytest

from core.errors import BadInput
from core.geometry.lens import lens_of, make_lens
from core.products.contract import read_product
from core.products.front import FocalProduct, FocalSpan, FramesProduct
from core.settings import make_settings
from core.settings.groups import CameraSettings
from core.sparse.lens import (
    choose_lens,
    focal_from_fov,
    fov_from_focal,
    principal_point,
    spans_said,
    start_lens,
)
from core.stage import StageTask
from core.stages import camera
from tests.core.making_products import facts_of

SIZES = facts_of(FramesProduct, crop=(38, 79, 825, 604), source_width=960, source_height=720, n_search=60)
FRAMES = read_product(FramesProduct, SIZES, "frames")


def start(
    fov: float,
    focal: float,
    registered: int = 60,
    points: int = 4000,
    error: float = 0.5,
    model: str = "OPENCV_FISHEYE",
) -> FocalProduct:
    return FocalProduct(
        fov_deg=fov,
        model=model,
        focal_px=focal,
        k1=0.02,
        registered=registered,
        points3D=points,
        mean_reprojection_error_px=error,
        frames=60,
        spans=(span(focal, registered, points),),
    )


def span(focal: float, registered: int, points: int = 900) -> FocalSpan:
    return FocalSpan(
        start=0,
        end=30,
        frames=30,
        focal_px=focal,
        k1=0.02,
        registered_images=registered,
        points3D=points,
        mean_reprojection_error_px=0.5,
    )


def test_an_equidistant_lens_of_180_degrees() -> None:
    assert focal_from_fov(180.0, 960) == pytest.approx(480 / (math.pi / 2))
    assert fov_from_focal(focal_from_fov(77.0, 960), 960) == pytest.approx(77.0)


def test_the_principal_point_is_the_source_frames_centre() -> None:
    assert principal_point(FRAMES, CameraSettings()) == (442.0, 281.0)
    assert principal_point(FRAMES, CameraSettings(principal_point="crop")) == (393.5, 262.5)


def test_a_start_is_a_prior() -> None:
    lens = start_lens(FRAMES, CameraSettings(), 90.0)
    assert lens.has_prior_focal_length
    assert (lens.width, lens.height) == (787, 525)
    assert list(lens.params) == pytest.approx([480 / math.radians(45), 442.0, 281.0, 0.0])


def test_a_given_view_counts_before_everything() -> None:
    chosen = choose_lens(FRAMES, CameraSettings(fov_deg=106.0), [start(40.0, 900.0)])
    assert chosen.focal_from == "given"
    assert chosen.params == pytest.approx([focal_from_fov(106.0, 960)] * 2 + [442.0, 281.0, 0, 0, 0, 0])


CALIBRATION = {"model": "PINHOLE", "params": (500.0, 500.0, 470.0, 350.0), "size_px": (960, 720)}


def test_a_calibration_is_moved_to_the_crop_and_scaled_to_the_video() -> None:
    settings = CameraSettings(**CALIBRATION, principal_point="crop")
    chosen = choose_lens(FRAMES, settings, [])
    assert (chosen.model, chosen.focal_from, chosen.flags) == ("PINHOLE", "calibration", ())
    assert chosen.params == (500.0, 500.0, 470.0 - 38, 350.0 - 79)
    twice = choose_lens(replace(FRAMES, source_width=1920, source_height=1440), settings, [])
    assert twice.params == (1000.0, 1000.0, 940.0 - 38, 700.0 - 79)


def test_a_calibration_of_another_shape_is_refused_with_both_sizes() -> None:
    with pytest.raises(BadInput, match="960x720 and the video has 960x719"):
        choose_lens(replace(FRAMES, source_height=719), CameraSettings(**CALIBRATION), [])


@pytest.mark.parametrize("model", ["OPENCV", "PINHOLE", "SIMPLE_RADIAL"])
def test_a_perspective_lens_starts_as_a_pinhole_of_the_same_view(model: str) -> None:
    settings = CameraSettings(model=model, fov_deg=90.0)
    chosen = choose_lens(FRAMES, settings, [])
    lens = make_lens(model, chosen.params)
    assert lens.fx == pytest.approx(480.0)
    assert (lens.cx, lens.cy) == (442.0, 281.0)
    assert fov_from_focal(480.0, 960, model) == pytest.approx(90.0)
    start = lens_of(start_lens(FRAMES, settings, 90.0))
    assert start.fx == pytest.approx(480.0)
    assert not start.fisheye


def test_colmaps_default() -> None:
    chosen = choose_lens(FRAMES, CameraSettings(focal="colmap"), [])
    assert (chosen.focal_from, chosen.reason) == ("colmap", "")
    assert chosen.params[0] == pytest.approx(944.4)


def test_the_start_that_registers_more_wins_and_then_the_smaller_error() -> None:
    starts = [start(40.0, 900.0, registered=30, error=0.1), start(55.0, 522.0, error=0.6), start(70.0, 520.0)]
    chosen = choose_lens(FRAMES, CameraSettings(), starts)
    assert (chosen.focal_from, chosen.chosen_start_deg, chosen.params[0]) == ("estimated", 70.0, 520.0)
    assert chosen.params[4] == 0.02
    assert chosen.agreement == pytest.approx(2 / 3)
    assert len(chosen.starts) == 3


@pytest.mark.parametrize(("agreeing", "flagged"), [(6, False), (3, False), (2, True)])
def test_starts_that_do_not_agree_are_flagged(agreeing: int, flagged: bool) -> None:
    starts = [start(40.0 + i, 520.0 + i if i < agreeing else 900.0 + 60 * i, error=0.5 + 0.1 * i) for i in range(6)]
    chosen = choose_lens(FRAMES, CameraSettings(), starts)
    assert [flag.code for flag in chosen.flags] == (["focal_uncertain"] if flagged else [])
    assert choose_lens(FRAMES, CameraSettings(fov_deg=106.0), starts).flags == ()


@pytest.mark.parametrize(
    ("found", "flagged"),
    [
        ([2751.3, 2751.9], False),  # of photographs of a fountain, 0.1 % off
        ([1446.0, 1933.0], True),  # of a sinus, where about 700 is right
        ([3418.0], True),  # of a tube at this width, where 1475 is right
        ([2751.3, 2790.0], True),
    ],
)
def test_starts_that_found_no_model_do_not_speak_against_those_that_did(found: list[float], flagged: bool) -> None:
    frames = replace(FRAMES, source_width=3072, crop=(0, 0, 3072, 2048))
    nothing = [start(70.0 + i, 2500.0 - 300.0 * i, registered=0, points=0) for i in range(4)]
    starts = [*(start(40.0 + i, focal, error=0.4 + 0.1 * i) for i, focal in enumerate(found)), *nothing]
    chosen = choose_lens(frames, CameraSettings(), starts)
    assert chosen.focal_from == "estimated"
    assert (chosen.agreement or 0.0) < 0.5
    assert [flag.code for flag in chosen.flags] == (["focal_uncertain"] if flagged else [])


def test_starts_that_found_nothing_fall_back_to_colmap_with_a_reason() -> None:
    starts = [
        start(40.0, 1375.0, registered=0, points=0),
        start(55.0, 500.0, registered=7),
        start(70.0, 500.0, points=20),
    ]
    chosen = choose_lens(FRAMES, CameraSettings(), starts)
    assert (chosen.focal_from, chosen.reason) == ("colmap", "no_start_found_a_model")
    assert chosen.agreement is None


def test_a_lens_that_ran_away_and_nobody_agrees_on_is_not_used() -> None:
    ran_away = start(40.0, focal_from_fov(20.0, 960))
    chosen = choose_lens(FRAMES, CameraSettings(), [ran_away, *(start(50.0 + i, 0.0, 0, 0) for i in range(5))])
    assert (chosen.focal_from, chosen.reason, chosen.chosen_start_deg) == ("colmap", "lens_unknown", None)
    assert chosen.params == pytest.approx([944.4, 944.4, 442.0, 281.0, 0, 0, 0, 0])
    assert [flag.code for flag in chosen.flags] == ["lens_unknown"]
    impossible = choose_lens(FRAMES, CameraSettings(), [start(55.0, 9000.0)])
    assert (impossible.focal_from, impossible.reason) == ("colmap", "lens_unknown")
    agreed = choose_lens(FRAMES, CameraSettings(), [ran_away, start(55.0, 1.02 * ran_away.focal_px, error=0.6)])
    assert agreed.focal_from == "estimated"


def test_a_start_whose_radial_term_ran_away_gives_way_to_one_that_maps_less() -> None:
    starts = [
        replace(start(40.0, 7000.0), k1=-1.05),
        replace(start(55.0, 700.0), k1=5.0),
        start(70.0, 520.0, registered=20),
    ]
    chosen = choose_lens(FRAMES, CameraSettings(), starts)
    assert (chosen.chosen_start_deg, chosen.params[0]) == (70.0, 520.0)
    nothing_left = choose_lens(FRAMES, CameraSettings(), starts[:2])
    assert (nothing_left.focal_from, nothing_left.reason) == ("colmap", "lens_unknown")
    assert [flag.code for flag in nothing_left.flags] == ["lens_unknown"]


ENDOSCOPE = replace(FRAMES, crop=(0, 0, 320, 256), source_width=320, source_height=256, n_search=201)
BY_FISHEYE = (
    start(55.0, 497.7, 30, 1748, 0.568),
    start(85.0, 486.6, 30, 1867, 0.556),
    start(120.0, 474.6, 30, 1864, 0.555),
)
"""What starts of a fisheye say of a slow endoscopic clip: focal length and radial term trade."""


def pinholes(*focal: float, registered: int = 30, points: int = 1944, error: float = 0.546) -> list[FocalProduct]:
    kept = registered, points, error, "PINHOLE"
    return [replace(start(55.0 + 30 * i, px, *kept), k1=0.0) for i, px in enumerate(focal)]


def test_a_pinhole_that_explains_as_much_by_less_is_the_lens() -> None:
    chosen = choose_lens(ENDOSCOPE, CameraSettings(), [*BY_FISHEYE, *pinholes(298.5, 298.0)])
    assert (chosen.model, chosen.params) == ("SIMPLE_RADIAL", (298.5, 160.0, 128.0, 0.0))
    assert (chosen.focal_from, chosen.agreement, chosen.flags) == ("estimated", 1.0, ())
    assert {one.model for one in chosen.starts} == {"PINHOLE"}
    assert chosen.other_starts == BY_FISHEYE
    alone = choose_lens(ENDOSCOPE, CameraSettings(), [start(55.0, 500.0, 5), *pinholes(298.5, 298.0)])
    assert (alone.model, alone.reason) == ("SIMPLE_RADIAL", "")


@pytest.mark.parametrize(
    "other",
    [
        pinholes(298.5, 298.0, error=0.556),
        pinholes(298.5, 298.0, registered=28),
        pinholes(298.5, 298.0, points=1600),
        pinholes(298.5, 320.0),
        [
            replace(one, spans=tuple(replace(one.spans[0], focal_px=px) for px in (332.0, 239.0)))
            for one in pinholes(285.0, 285.0)
        ],
        [*pinholes(298.5), start(85.0, 298.0, 0, 0, 0.0, "PINHOLE")],
        [],
    ],
    ids=["larger error", "fewer images", "fewer points", "two answers", "spans apart", "one answer", "none"],
)
def test_else_the_lens_stays_a_fisheye(other: list[FocalProduct]) -> None:
    chosen = choose_lens(ENDOSCOPE, CameraSettings(), [*BY_FISHEYE, *other])
    assert (chosen.model, chosen.params[0], chosen.chosen_start_deg) == ("OPENCV_FISHEYE", 474.6, 120.0)
    assert (chosen.starts, chosen.agreement) == (BY_FISHEYE, 1.0)
    assert list(chosen.other_starts) == other


def test_what_the_spans_of_the_chosen_start_said() -> None:
    spans = (span(510.0, 30), span(9000.0, 3))
    starts = [replace(start(40.0, 519.0), spans=spans), start(55.0, 530.0, registered=8)]
    assert spans_said(choose_lens(FRAMES, CameraSettings(), starts)) == [510.0]
    assert spans_said(choose_lens(FRAMES, CameraSettings(fov_deg=106.0), [])) == []


def test_the_stage_writes_what_it_says(tmp_path: Path) -> None:
    facts = {"frames": SIZES, "focal/040.0": start(40.0, 519.0).facts}
    result = camera.run(StageTask("camera", {}, make_settings(), {}, facts, (), tmp_path))
    assert json.loads((tmp_path / "camera.json").read_text()) == result.facts
    assert result.model == "OPENCV_FISHEYE"
