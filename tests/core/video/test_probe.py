"""Probe and frame table: exact times, the frame everyone sees, and damage that is noticed."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from core.errors import BadInput, Cancelled
from core.video.decode import iter_frames
from core.video.probe import probe_video
from core.video.table import FrameTable, VideoInfo
from tests.core.making_videos import cut_to, every_ms, make_video, picture, set_display_matrix
from tests.inputs import INPUTS

SAMPLE = Path(__file__).parents[3] / "samples" / "turbine.mp4"


@pytest.fixture(scope="module")
def whole() -> FrameTable:
    return probe_video(SAMPLE)


def test_the_sample_is_what_its_readme_says(whole: FrameTable) -> None:
    table = whole
    info = table.info
    assert (info.width, info.height, info.n_frames, info.codec) == (960, 720, 96, "h264")
    assert info.average_rate == 12
    assert info.duration_s == 8.0
    assert not info.truncated
    assert table.time(95) == Fraction(95, 12)
    assert [row.index for row in table.rows if row.keyframe] == [0, 48]
    assert len({row.sha256 for row in table.rows}) == 96


def test_hashes_are_those_of_the_rgb_frames(tmp_path: Path) -> None:
    video = make_video(tmp_path / "a.mp4", every_ms(40, 10))
    table = probe_video(video)
    for (index, pts, time_s, rgb), row in zip(iter_frames(video), table.rows, strict=True):
        assert rgb.shape == (128, 160, 3)
        assert rgb.dtype == np.uint8
        assert (index, pts, time_s) == (row.index, row.pts, row.time_s)
        assert hashlib.sha256(rgb.tobytes()).hexdigest() == row.sha256
        assert np.abs(rgb.astype(int) - picture(index)).mean() < 12


def test_the_declared_rate_is_kept_beside_the_measured_one(tmp_path: Path) -> None:
    table = probe_video(INPUTS / "m96_drop15.avi")
    assert table.info.declared_rate == 12
    assert float(table.info.average_rate) == pytest.approx(89 / (95 / 12))
    table.write(tmp_path)
    assert FrameTable.read(tmp_path).info == table.info
    older = {name: value for name, value in table.info.to_dict().items() if name != "declared_rate"}
    assert VideoInfo.from_dict(older).declared_rate is None


@pytest.mark.parametrize("suffix", ["mp4", "mkv"])
def test_variable_frame_rate_keeps_exact_times(tmp_path: Path, suffix: str) -> None:
    times = [0, 40, 80, 200, 210, 1000, 1033, 1500]
    table = probe_video(make_video(tmp_path / f"vfr.{suffix}", times))
    assert [table.time(i) for i in range(len(times))] == [Fraction(t, 1000) for t in times]
    assert [row.time_s for row in table.rows] == [t / 1000 for t in times]
    assert float(table.info.average_rate) == pytest.approx(7 / 1.5, rel=0.25)
    assert table.nearest(Fraction(139, 1000)) == 2
    assert table.nearest(Fraction(141, 1000)) == 3
    assert table.nearest(Fraction(140, 1000)) == 2


def test_times_count_from_the_first_frame(tmp_path: Path) -> None:
    table = probe_video(make_video(tmp_path / "late.ts", [500, 540, 580, 620]))
    assert table.rows[0].time_s == 0.0
    assert table.time(3) == Fraction(120, 1000)


@pytest.mark.parametrize(
    ("matrix", "rotation", "mirrored", "shown"),
    [
        ((1, 0, 0, 1), 0, False, lambda image: image),
        ((0, 1, -1, 0), 90, False, lambda image: np.rot90(image, -1)),
        ((-1, 0, 0, -1), 180, False, lambda image: np.rot90(image, 2)),
        ((0, -1, 1, 0), 270, False, lambda image: np.rot90(image)),
        ((-1, 0, 0, 1), 0, True, lambda image: image[:, ::-1]),
        ((1, 0, 0, -1), 180, True, lambda image: np.rot90(image[:, ::-1], 2)),
        ((0, 1, 1, 0), 270, True, lambda image: np.rot90(image[:, ::-1])),
        ((0, -1, -1, 0), 90, True, lambda image: np.rot90(image[:, ::-1], -1)),
    ],
)
def test_the_rotation_flag_is_applied(
    tmp_path: Path,
    matrix: tuple[int, int, int, int],
    rotation: int,
    mirrored: bool,
    shown: Callable[[NDArray[np.uint8]], NDArray[np.uint8]],
) -> None:
    plain = make_video(tmp_path / "plain.mp4", every_ms(40, 3))
    coded = [rgb for *_, rgb in iter_frames(plain)]
    turned = set_display_matrix(make_video(tmp_path / "turned.mp4", every_ms(40, 3)), *matrix)
    info = probe_video(turned).info
    assert (info.rotation_deg, info.mirrored) == (rotation, mirrored)
    for image, (*_, rgb) in zip(coded, iter_frames(turned), strict=True):
        assert np.array_equal(rgb, shown(image))
        assert (info.height, info.width) == rgb.shape[:2]


def test_a_video_turned_by_45_degrees_is_refused(tmp_path: Path) -> None:
    video = set_display_matrix(make_video(tmp_path / "a.mp4", every_ms(40, 3)), 1, 1, -1, 1)
    with pytest.raises(BadInput, match="multiple of 90") as caught:
        probe_video(video)
    assert caught.value.code == "unsupported_rotation"


@pytest.mark.parametrize("share", [0.1, 0.35])
def test_the_decodable_part_of_a_truncated_video_is_exact(tmp_path: Path, share: float, whole: FrameTable) -> None:
    cut = cut_to(SAMPLE, share, tmp_path / "cut.mp4")
    with pytest.raises(BadInput, match=r"'cut.mp4' is truncated or damaged") as caught:
        probe_video(cut)
    assert caught.value.code == "truncated_video"
    part = probe_video(cut, allow_truncated=True)
    assert part.info.truncated
    assert part.info.damage
    assert 0.5 * share * 96 < len(part.rows) < 96
    hashes = {row.pts: row.sha256 for row in whole.rows}
    assert all(hashes[row.pts] == row.sha256 for row in part.rows)
    assert [index for index, *_ in iter_frames(cut)] == list(range(len(part.rows)))


def test_a_truncated_matroska_is_noticed_by_its_duration(tmp_path: Path) -> None:
    video = make_video(tmp_path / "a.mkv", every_ms(40, 100))
    assert not probe_video(video).info.truncated
    cut = cut_to(video, 0.5, tmp_path / "cut.mkv")
    with pytest.raises(BadInput, match="missing at the end"):
        probe_video(cut)


def test_after_damage_inside_frames_go_on_at_the_next_keyframe(tmp_path: Path, whole: FrameTable) -> None:
    data = bytearray(SAMPLE.read_bytes())
    middle = len(data) // 4
    data[middle : middle + 20_000] = bytes(20_000)
    broken = tmp_path / "broken.mp4"
    broken.write_bytes(data)
    part = probe_video(broken, allow_truncated=True)
    assert len(part.info.damage) == 1
    assert part.info.damage[0].startswith("27 frames lost after frame 20 at 1.667 s")
    hashes = {row.pts: row.sha256 for row in whole.rows}
    assert all(hashes[row.pts] == row.sha256 for row in part.rows), "no frame is shown that refers to a broken one"
    assert {row.pts for row in part.rows} >= {pts for pts in hashes if pts >= 48 * 1024}
    assert len(part.rows) < 96


def test_the_table_survives_its_files(tmp_path: Path) -> None:
    table = probe_video(make_video(tmp_path / "a.mp4", [0, 33, 67, 100]))
    table.write(tmp_path)
    assert FrameTable.read(tmp_path) == table


def test_a_key_finds_its_frame_only_within_the_video(tmp_path: Path) -> None:
    table = probe_video(make_video(tmp_path / "a.mp4", every_ms(100, 10)))
    assert table.frame_at(Fraction(0)) == 0
    assert table.frame_at(Fraction("0.349")) == 3
    assert table.frame_at(Fraction("-0.05")) == 0
    assert table.frame_at(Fraction("-0.051")) is None
    assert table.frame_at(Fraction("0.999")) == 9
    assert table.frame_at(Fraction("1.001")) is None


def test_probing_can_be_stopped() -> None:
    def stop(done: int, declared: int) -> None:
        assert declared == 96
        if done == 3:
            raise Cancelled("stop")

    with pytest.raises(Cancelled):
        probe_video(SAMPLE, on_frame=stop)


def test_a_changing_frame_size_is_refused(tmp_path: Path) -> None:
    small = make_video(tmp_path / "a.ts", every_ms(40, 20)).read_bytes()
    large = make_video(tmp_path / "b.ts", every_ms(40, 20), size=(176, 144)).read_bytes()
    joined = tmp_path / "joined.ts"
    joined.write_bytes(small + large)
    with pytest.raises(BadInput, match=r"frame size of 'joined.ts' changes at frame") as caught:
        probe_video(joined)
    assert caught.value.code == "frame_size_changes"


def test_a_recording_may_begin_in_the_middle_of_a_group(tmp_path: Path) -> None:
    whole = make_video(tmp_path / "a.ts", every_ms(40, 30))
    late = tmp_path / "late.ts"
    late.write_bytes(whole.read_bytes()[188 * 30 :])
    table = probe_video(late)
    assert not table.info.truncated
    assert table.rows[0].keyframe
    hashes = {row.pts: row.sha256 for row in probe_video(whole).rows}
    assert all(hashes[row.pts] == row.sha256 for row in table.rows)


def test_times_that_start_again_go_on(tmp_path: Path) -> None:
    part = make_video(tmp_path / "a.ts", every_ms(40, 20)).read_bytes()
    twice = tmp_path / "twice.ts"
    twice.write_bytes(part * 2)
    table = probe_video(twice)
    assert (table.info.joined, table.info.repaired_times) == ((20,), 0)
    assert [table.time(i) for i in range(40)] == [Fraction(i, 25) for i in range(40)]
