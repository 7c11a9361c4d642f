from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from core.features.io import FrameFeatures, write_features
from core.io.frames import write_frames
from core.matching.keyframes import Keyframes, write_keyframes
from core.products.contract import read_product
from core.products.front import FramesProduct
from core.scene.frame import Crop, Frame, Role, RunFrames
from core.settings import make_settings, only_declared
from core.sparse import focal as search
from core.sparse.focal import GAPS, SpanFocal, choose_spans, find_focal, joined
from core.sparse.lens import fov_from_focal, start_lens
from core.stage import StageTask
from core.stage_specs import STAGES
from core.stages import focal
from tests.core.making_products import facts_of
from tests.core.sparse.scene import FOCAL, HEIGHT, WIDTH, Scene, make_scene

TRUE_FOV = fov_from_focal(FOCAL, WIDTH)


CAMERA = make_settings().camera
SIZES = facts_of(FramesProduct, crop=(0, 0, WIDTH, HEIGHT), source_width=WIDTH, source_height=HEIGHT)


def found(registered: int, k1: float = 0.0) -> SpanFocal:
    """What a span of 24 keyframes said."""
    return SpanFocal(0, 24, 24, FOCAL, k1, registered, 500, 0.5)


def task(scene: Scene, folder: Path, fov_deg: float) -> StageTask:
    features = folder / "features"
    if not features.exists():
        features.mkdir()
        for index, found in enumerate(scene.features):
            write_features(features / f"{index:04d}.npz", found)
    frames = {**SIZES, "n_search": len(scene.features)}
    table = folder / "frames"
    if not table.exists():
        table.mkdir()
        all_of_one = (Frame(i, i, i, i / 30, "", Role.SAMPLED) for i in range(len(scene.features)))
        write_frames(table, RunFrames(tuple(all_of_one)), Crop(0, 0, WIDTH, HEIGHT, WIDTH, HEIGHT))
    whole = make_settings("default", {"camera.focal_span": 14, "camera.focal_spans": 1})
    settings = only_declared(whole, STAGES["focal"].settings)  # as in a run
    inputs = {"features/000": features, "frames": table}
    return StageTask("focal", {"fov_deg": fov_deg}, settings, inputs, {"frames": frames}, (), folder)


@pytest.mark.parametrize("wrong", [0.6, 1.25])
def test_a_wrong_start_ends_at_the_true_focal_length(wrong: float, tmp_path: Path) -> None:
    facts = focal.run(task(make_scene(16, 700), tmp_path, TRUE_FOV * wrong)).facts
    assert facts["registered"] == facts["frames"] == 14
    assert facts["focal_px"] == pytest.approx(FOCAL, rel=0.05)
    assert facts["mean_reprojection_error_px"] < 0.6


def test_a_turning_camera_says_nothing(tmp_path: Path) -> None:
    facts = focal.run(task(make_scene(16, 400, step=0.0), tmp_path, TRUE_FOV)).facts
    assert (facts["registered"], facts["points3D"]) == (0, 0)
    assert facts["focal_px"] == pytest.approx(FOCAL)


def test_spans_lie_where_the_camera_moves() -> None:
    still, moving = make_scene(1, 400), make_scene(20, 400)
    features = still.features * 40 + moving.features
    spans = choose_spans(range(60), 12, 1, lambda index: features[index])
    assert len(spans) == 1
    assert spans[0][0] >= 30
    assert spans[0] == tuple(range(spans[0][0], spans[0][0] + 12))


def test_spans_cover_sections_and_short_clips() -> None:
    features = make_scene(30, 200).features
    first, second = choose_spans(range(30), 10, 2, lambda index: features[index])
    assert first[-1] < 15 <= second[0]
    assert second[-1] < 30
    assert choose_spans(range(8), 30, 2, lambda index: features[index]) == [tuple(range(8))]


def test_no_span_reaches_over_a_cut_between_two_videos() -> None:
    features = make_scene(30, 200).features
    videos = [0] * 17 + [1] * 13

    def load(index: int) -> FrameFeatures:
        return features[index]

    for length, count in ((10, 1), (10, 2), (14, 2), (30, 1)):
        for span in choose_spans(range(30), length, count, load, videos):
            assert len({videos[frame] for frame in span}) == 1
            assert len(span) >= min(length, 13)
    assert choose_spans(range(30), 30, 1, load, videos) == [tuple(range(17))]


def test_spans_consist_of_keyframes() -> None:
    features = make_scene(30, 200).features
    keyframes = (0, 3, 4, 9, 12, 15, 21, 22, 27, 29)
    spans = choose_spans(keyframes, 4, 2, lambda index: features[index])
    assert [len(span) for span in spans] == [4, 4]
    assert all("".join(map(chr, span)) in "".join(map(chr, keyframes)) for span in spans)


def test_a_slow_clip_is_mapped_on_its_keyframes(tmp_path: Path) -> None:
    scene = make_scene(70, 900, step=0.02)
    slow = task(scene, tmp_path, TRUE_FOV * 0.8)
    keyframes = tuple(range(0, 70, 5))
    folder = tmp_path / "motion"
    folder.mkdir()
    write_keyframes(folder, Keyframes(keyframes, (0.03,) * (len(keyframes) - 1)))
    facts = focal.run(replace(slow, inputs={**slow.inputs, "motion": folder})).facts
    assert facts["registered"] == facts["frames"] == len(keyframes)
    assert [(span["start"], span["end"]) for span in facts["spans"]] == [(0, 66)]
    assert facts["focal_px"] == pytest.approx(FOCAL, rel=0.05)


def test_spans_are_joined_by_their_points() -> None:
    found = joined(
        85.0,
        "OPENCV_FISHEYE",
        [SpanFocal(0, 30, 30, 500.0, 0.1, 30, 3000, 0.5), SpanFocal(40, 90, 30, 520.0, 0.2, 20, 1000, 0.9)],
    )
    assert found.focal_px == pytest.approx(math.exp(0.75 * math.log(500) + 0.25 * math.log(520)))
    assert found.k1 == pytest.approx(0.125)
    assert (found.registered, found.points3D, found.frames) == (50, 4000, 60)
    assert found.mean_reprojection_error_px == pytest.approx(0.6)
    nothing = joined(85.0, "OPENCV_FISHEYE", [SpanFocal(0, 30, 30, 700.0, 0.0, 0, 0, 0.0)])
    assert (nothing.focal_px, nothing.registered) == (700.0, 0)


@pytest.mark.parametrize(
    ("near", "wide", "kept"),
    [
        (found(20), found(24), "near"),
        (found(10), found(20), "wide"),
        (found(10), found(5), "near"),
        (found(20, k1=1.2), found(18), "wide"),
        (found(20, k1=1.2), found(24, k1=-1.2), "wide"),
        (found(20, k1=1.2), found(10, k1=-1.2), "near"),
    ],
)
def test_a_span_that_comes_apart_is_tried_with_wider_pairs(
    near: SpanFocal, wide: SpanFocal, kept: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[Sequence[int]] = []

    class Span:
        def __init__(self, *_arguments: object) -> None:
            pass

        def map(self, gaps: Sequence[int]) -> SpanFocal:
            asked.append(gaps)
            return near if len(asked) == 1 else wide

    monkeypatch.setattr(search, "_Span", Span)
    lens = start_lens(read_product(FramesProduct, SIZES, "frames"), CAMERA, TRUE_FOV)
    result = find_focal(range(24), lens, make_settings(), lambda _: make_scene(1, 9).features[0], lambda *_: None)
    assert result == {"near": near, "wide": wide}[kept]
    assert asked[0] == GAPS
    assert (len(asked) > 1) == (near.registered_images < 0.8 * 24 or near.k1 > 1)
    assert all(set(gaps) > set(GAPS) for gaps in asked[1:])
