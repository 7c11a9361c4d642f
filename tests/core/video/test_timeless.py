"""Files that hold no times of their own, and ends of files that say little of how long they last."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest

from core.errors import BadInput
from core.video.probe import probe_video
from tests.core.making_films import SAMPLE, SMALL, ffmpeg, ffmpeg_pixels, film
from tests.core.making_videos import cut_to
from tests.inputs import INPUTS

RAW: dict[str, tuple[tuple[str, ...], bool]] = {
    "a.h264": (("-c:v", "libx264", "-bf", "2"), True),
    "a.hevc": (("-c:v", "libx265", "-x265-params", "log-level=none"), True),
    "a.m2v": (("-c:v", "mpeg2video", "-bf", "2", "-r", "24"), True),
    "a.obu": (("-c:v", "libaom-av1", "-cpu-used", "8"), False),
    "a.mjpeg": (("-c:v", "mjpeg"), False),
    "a.mpjpeg": (("-c:v", "mjpeg", "-f", "mpjpeg"), False),
}
"""How each is encoded, and whether its own header states a rate."""


@pytest.mark.tool("ffmpeg")
@pytest.mark.parametrize("name", RAW)
def test_a_raw_stream_keeps_its_rate_or_takes_the_one_that_is_told(name: str, tmp_path: Path) -> None:
    words, stated = RAW[name]
    path = film(tmp_path / name, *words)
    count = len(ffmpeg_pixels(path, "v:0", 160, 120))
    own, told = probe_video(path), probe_video(path, fps=15.5)
    rate = Fraction(24 if name == "a.m2v" else 12) if stated else Fraction(25)
    assert (own.info.average_rate, own.info.times_from) == (rate, "stream" if stated else "assumed")
    assert (told.info.average_rate, told.info.times_from) == (Fraction(31, 2), "given")
    for table, used in ((own, rate), (told, Fraction(31, 2))):
        assert [table.time(i) for i in range(table.info.n_frames)] == [i / used for i in range(table.info.n_frames)]
        assert table.info.duration_s == pytest.approx(float(table.info.n_frames / used))
        assert (table.info.repaired_times, table.info.joined, table.info.damage) == (0, (), ())
    assert own.info.n_frames == count
    assert [row.sha256 for row in own.rows] == [row.sha256 for row in told.rows]


def test_the_rate_in_the_stream_is_taken_before_what_the_container_assumes() -> None:
    info = probe_video(INPUTS / "raw.h264").info
    assert (info.average_rate, info.n_frames, info.duration_s) == (Fraction(12), 48, 4.0)
    assert (info.times_from, info.repaired_times) == ("stream", 0)


@pytest.mark.parametrize("name", ["m96.avi", "twov.mp4", "concat_disc.ts"])
def test_a_file_with_times_takes_no_rate(name: str) -> None:
    with pytest.raises(BadInput, match=rf"'{name}' holds the times of its frames; input\.fps is for") as caught:
        probe_video(INPUTS / name, fps=12)
    assert (caught.value.code, caught.value.where) == ("fps_not_needed", "input.fps")
    assert probe_video(INPUTS / name).info.times_from == "file"


SLOW = ("-vf", "setpts=N/5.6/TB", "-r", "5.6", "-c:v", "wmv2")


@pytest.mark.tool("ffmpeg")
@pytest.mark.parametrize("sound_s", ["7.9", "8.45", "9.4"])
def test_a_film_of_few_frames_per_second_whose_sound_goes_on_is_whole(sound_s: str, tmp_path: Path) -> None:
    """ASF that states no rate; its last picture comes 7.86 s after the first."""
    small = film(tmp_path / "small.mkv", "-c:v", "ffv1")
    tone = ("-f", "lavfi", "-i", f"sine=duration={sound_s}")
    path = ffmpeg(tmp_path / "slow.asf", "-i", small, *tone, *SLOW, "-frames:v", "45", "-c:a", "wmav2")
    info = probe_video(path).info
    assert (info.n_frames, info.damage) == (45, ())
    assert float(info.average_rate) == pytest.approx(5.6, rel=0.01)


@pytest.mark.tool("ffmpeg")
@pytest.mark.parametrize("rate", ["1", "0.5"])
def test_the_last_of_few_pictures_lasts_as_long_as_the_others(rate: str, tmp_path: Path) -> None:
    words = ("-vf", f"setpts=N/{rate}/TB,scale=160:120", "-r", rate, "-frames:v", "6", "-c:v", "wmv2")
    path = ffmpeg(tmp_path / "slow.asf", "-i", SAMPLE, *words)
    info = probe_video(path).info
    assert (info.n_frames, info.damage) == (6, ())
    cut = cut_to(path, 0.6, tmp_path / "cut.asf")
    assert probe_video(cut, allow_truncated=True).info.damage, "what is missing beyond that is still noticed"


@pytest.mark.tool("ffmpeg")
def test_a_film_that_is_cut_off_is_noticed_at_any_rate(tmp_path: Path) -> None:
    path = ffmpeg(tmp_path / "whole.mkv", "-i", SAMPLE, *SMALL, *SLOW[2:4], "-c:v", "mjpeg")
    assert not probe_video(path).info.damage
    with pytest.raises(BadInput, match=r"[34]\.\d s missing at the end"):
        probe_video(cut_to(path, 0.6, tmp_path / "cut.mkv"))
