"""Files as recorders write them: the film is found and no frame of it is lost, taken from elsewhere, or mistimed."""

from __future__ import annotations

import resource
import subprocess
import sys
from collections.abc import Callable
from fractions import Fraction
from itertools import islice
from pathlib import Path

import av
import numpy as np
import pytest

from core.errors import BadInput
from core.video.decode import VideoReader, iter_frames
from core.video.probe import probe_video
from tests.core.making_films import SAMPLE, ffmpeg, ffmpeg_pixels, ffprobe_frames, film
from tests.core.making_videos import cut_to, every_ms, make_video
from tests.inputs import INPUTS

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[3]

X264 = ("-c:v", "libx264", "-preset", "ultrafast")
X264_B = ("-c:v", "libx264", "-x264-params", "open-gop=1:keyint=12:bframes=3:b-pyramid=normal")
X265_B = ("-c:v", "libx265", "-x265-params", "open-gop=1:keyint=12:log-level=none")
TONE = ("-f", "lavfi", "-i", "sine=duration=4")
SUBTITLE = b"1\n00:00:00,000 --> 00:00:03,000\nstage 2\n"


@pytest.mark.parametrize(
    ("name", "frames", "size"),
    [
        ("afirst.mp4", 48, (480, 360)),
        ("twov.mp4", 48, (480, 360)),
        ("cover_noflag.mp4", 48, (480, 360)),
        ("kvz.mp4", 48, (480, 360)),
        ("concat_disc.ts", 96, (480, 360)),
    ],
)
def test_the_film_is_whole_at_12_frames_per_second(name: str, frames: int, size: tuple[int, int]) -> None:
    table = probe_video(INPUTS / name)
    info = table.info
    assert ((info.width, info.height), info.n_frames, info.damage) == (size, frames, ())
    assert (info.average_rate, info.duration_s) == (Fraction(12), frames / 12)
    assert [table.time(i) for i in range(frames)] == pytest.approx([i / 12 for i in range(frames)], abs=1e-4)


def test_the_stream_taken_is_named_where_there_was_a_choice() -> None:
    two = probe_video(INPUTS / "twov.mp4").info
    assert two.stream == 1
    assert two.streams == ("stream 0 (mjpeg, 160x120, 4 frames)", "stream 1 (h264, 480x360, 48 frames)")
    assert probe_video(INPUTS / "cover_noflag.mp4").info.streams[0] == "stream 0 (mjpeg, 480x360, 1 frame)"
    assert probe_video(INPUTS / "afirst.mp4").info.streams == ()


def test_another_stream_can_be_asked_for() -> None:
    preview = probe_video(INPUTS / "twov.mp4", stream=0).info
    assert (preview.stream, preview.width, preview.n_frames) == (0, 160, 4)
    with pytest.raises(BadInput, match=r"no video stream 2; its video streams: stream 0 .*, stream 1 ") as caught:
        probe_video(INPUTS / "twov.mp4", stream=2)
    assert caught.value.code == "no_such_stream"


def audio_first(folder: Path, suffix: str) -> tuple[Path, str]:
    made = film(folder / "film.mp4", *(X264 if suffix == "avi" else X264_B))  # AVI holds no times of B-frames
    return ffmpeg(folder / f"a.{suffix}", *TONE, "-i", made, "-map", "0", "-map", "1", "-c:v", "copy"), "v:0"


def text_first(folder: Path, suffix: str) -> tuple[Path, str]:
    made = film(folder / "film.mp4", *X264_B)
    (folder / "t.srt").write_bytes(SUBTITLE)
    words: list[str | Path] = ["-i", folder / "t.srt", "-i", made, "-map", "0", "-map", "1", "-c:v", "copy"]
    return ffmpeg(folder / f"t.{suffix}", *words, *(["-c:s", "mov_text"] if suffix == "mp4" else [])), "v:0"


def preview_first(folder: Path, suffix: str) -> tuple[Path, str]:
    """A small preview of as many seconds, marked as default like the film or instead of it."""
    made = film(folder / "film.mp4", *X264_B)
    small = ffmpeg(folder / "small.mp4", "-i", made, "-vf", "scale=64:48", *X264)
    words: list[str | Path] = ["-i", small, "-i", made, "-map", "0", "-map", "1", "-c", "copy"]
    return ffmpeg(folder / f"p.{suffix}", *words, "-disposition:v:0", "default", "-disposition:v:1", "0"), "v:1"


def cover_first(folder: Path, suffix: str) -> tuple[Path, str]:
    made = film(folder / "film.mp4", *X264_B)
    cover = ffmpeg(folder / "cover.jpg", "-i", SAMPLE, "-frames:v", "1")
    words: list[str | Path] = ["-i", cover, "-i", made, "-map", "0", "-map", "1", "-c", "copy"]
    return ffmpeg(folder / f"c.{suffix}", *words, "-disposition:v:0", "default"), "v:1"


@pytest.mark.tool("ffmpeg")
@pytest.mark.parametrize(
    ("make", "suffix"),
    [
        (audio_first, "mp4"),
        (audio_first, "mkv"),
        (audio_first, "ts"),
        (audio_first, "avi"),
        (text_first, "mp4"),
        (text_first, "mkv"),
        (preview_first, "mp4"),
        (preview_first, "mkv"),
        (preview_first, "ts"),
        (cover_first, "mp4"),
        (cover_first, "mkv"),
    ],
)
def test_the_film_among_other_streams_is_what_ffprobe_lists(
    make: Callable[[Path, str], tuple[Path, str]], suffix: str, tmp_path: Path
) -> None:
    path, stream = make(tmp_path, suffix)
    expected = ffprobe_frames(path, stream)
    table = probe_video(path)
    assert (table.info.stream, table.info.damage) == (expected.index, ())
    assert [row.pts for row in table.rows] == expected.pts
    shown = ffmpeg_pixels(path, str(expected.index), 160, 120)
    ours = np.stack([rgb for *_, rgb in iter_frames(path)])
    assert ours.shape == shown.shape
    assert np.abs(ours.astype(int) - shown.astype(int)).mean(axis=(1, 2, 3)).max() < 3


KINDS = {
    "b-frames.mkv": X264_B,
    "b-frames.ts": X264_B,
    "b-frames.flv": X264_B,
    "b-frames-265.mp4": X265_B,
    "fields.mp4": ("-c:v", "libx264", "-flags", "+ildct+ilme", "-x264-params", "interlaced=1"),
    "fields.ts": ("-c:v", "mpeg2video", "-flags", "+ildct+ilme"),
    "refresh.mp4": ("-c:v", "libx264", "-x264-params", "intra-refresh=1:keyint=12"),
    "hidden.webm": ("-c:v", "libvpx", "-auto-alt-ref", "1", "-lag-in-frames", "16", "-b:v", "200k"),
    "hidden-9.webm": ("-c:v", "libvpx-vp9", "-cpu-used", "8"),
    "old.asf": ("-c:v", "wmv2"),
    "pictures.avi": ("-c:v", "mjpeg"),
    "ps.mpg": ("-c:v", "mpeg2video"),
    "fragments.mp4": (*X264_B, "-movflags", "frag_keyframe+empty_moov"),
    "tape.dv": ("-vf", "scale=720:576", "-pix_fmt", "yuv420p", "-r", "25"),
    "small.gif": (),
    "b-frames.nut": ("-c:v", "mpeg4", "-bf", "2"),
    "plain.y4m": ("-pix_fmt", "yuv420p"),
    "real.rm": ("-c:v", "rv20"),
    "plain.ivf": ("-c:v", "libvpx", "-b:v", "200k"),
}


@pytest.mark.tool("ffmpeg")
@pytest.mark.parametrize("name", KINDS)
def test_an_intact_film_is_what_ffprobe_lists_and_no_damage_is_invented(name: str, tmp_path: Path) -> None:
    path = film(tmp_path / name, *KINDS[name])
    table = probe_video(path)
    assert (table.info.damage, table.info.repaired_times, table.info.joined) == ((), 0, ())
    assert (table.info.damaged_pictures, table.info.times_from) == ((), "file")
    assert [f"{float(row.pts * table.info.time_base):.6f}" for row in table.rows] == ffprobe_frames(path).times


@pytest.mark.tool("ffmpeg")
@pytest.mark.parametrize("cut", [("-ss", "1.3"), ("-ss", "0.5", "-t", "2")])
def test_frames_that_an_edit_list_cuts_away_are_no_damage(cut: tuple[str, ...], tmp_path: Path) -> None:
    whole = film(tmp_path / "whole.mp4", *X264_B)
    path = ffmpeg(tmp_path / "cut.mov", *cut[:2], "-i", whole, *cut[2:], "-c", "copy")
    table = probe_video(path)
    assert table.info.damage == ()
    assert [row.pts for row in table.rows] == ffprobe_frames(path).pts


@pytest.mark.tool("ffmpeg")
@pytest.mark.parametrize("codec", [X264_B, ("-c:v", "mpeg4", "-bf", "2")])
def test_avi_which_has_no_presentation_times_keeps_an_even_rate(codec: tuple[str, ...], tmp_path: Path) -> None:
    table = probe_video(film(tmp_path / "a.avi", *codec))
    assert (table.info.average_rate, table.info.repaired_times) == (Fraction(12), 0)
    assert [table.time(i) for i in range(48)] == [Fraction(i, 12) for i in range(48)]


@pytest.mark.tool("ffmpeg")
@pytest.mark.parametrize(
    ("suffix", "codec", "parts"),
    [("ts", X264_B, 2), ("ts", ("-c:v", "mpeg2video", "-bf", "2"), 3), ("mpg", ("-c:v", "mpeg2video"), 2)],
)
def test_joined_recordings_go_on_in_time(suffix: str, codec: tuple[str, ...], parts: int, tmp_path: Path) -> None:
    part = film(tmp_path / f"part.{suffix}", *codec)
    joined = tmp_path / f"joined.{suffix}"
    joined.write_bytes(part.read_bytes() * parts)
    one, table = probe_video(part), probe_video(joined)
    assert (table.info.joined, table.info.repaired_times) == (tuple(48 * i for i in range(1, parts)), 0)
    assert [float(table.time(i)) for i in range(48 * parts)] == pytest.approx([i / 12 for i in range(48 * parts)])
    assert [row.sha256 for row in table.rows] == [row.sha256 for row in one.rows] * parts


@pytest.mark.parametrize("name", ["d_x265_rand.mp4", "d_x264g12_rand.mp4"])
def test_frames_that_the_decoder_loses_without_a_word_are_damage_with_a_place(name: str) -> None:
    with pytest.raises(BadInput, match=r"4 frames lost after frame 18 at 1\.500 s") as caught:
        probe_video(INPUTS / name)
    assert caught.value.code == "truncated_video"
    part = probe_video(INPUTS / name, allow_truncated=True)
    # Frame 19 is lost; frame 20 was decoded before it; 21 to 23 may refer to it; 24 is a keyframe.
    assert [round(row.time_s * 12) for row in part.rows] == [*range(19), 20, *range(24, 48)]
    assert part.info.average_rate == 12


def overwrite_packet(path: Path, number: int) -> None:
    """Make nothing of one packet of the first stream."""
    with av.open(str(path)) as container:
        packet = next(islice(container.demux(video=0), number, None))
        start, size = packet.pos, packet.size
        assert start is not None
    data = bytearray(path.read_bytes())
    data[start : start + size] = bytes(size)
    path.write_bytes(data)


@pytest.mark.tool("ffmpeg")
@pytest.mark.parametrize(
    "codec",
    [
        X264_B,
        X265_B,
        ("-c:v", "mpeg4", "-bf", "2", "-g", "12"),
        ("-c:v", "libx265", "-x265-params", "bframes=0:keyint=12:log-level=none"),
    ],
)
def test_what_is_shown_of_a_damaged_film_is_sound_and_what_is_not_is_named(
    codec: tuple[str, ...], tmp_path: Path
) -> None:
    path = film(tmp_path / "whole.mp4", *codec)
    whole = {row.pts: row.sha256 for row in probe_video(path).rows}
    overwrite_packet(path, 26)
    part = probe_video(path, allow_truncated=True)
    assert part.info.damage
    assert "lost after frame" in part.info.damage[0]
    assert 12 <= len(part.rows) < 48
    assert all(whole[row.pts] == row.sha256 for row in part.rows)


@pytest.mark.tool("ffmpeg")
@pytest.mark.parametrize("when", range(30, 48))
def test_a_film_is_sound_whenever_the_frames_of_another_reader_are_let_go(when: int, tmp_path: Path) -> None:
    """PyAV keeps what packets carry by the address of an object, and small numbers are the same object everywhere."""
    path = film(tmp_path / "whole.mp4", *X264_B)
    with VideoReader(path) as other:
        held = list(other.frames())
    shown = 0
    with VideoReader(path) as reader:
        for shown, _ in enumerate(reader.frames(), start=1):
            if shown > when:
                held.clear()
    assert (shown, reader.losses) == (48, [])


def test_frames_that_the_index_lists_and_the_file_lacks_are_counted(tmp_path: Path) -> None:
    cut = cut_to(SAMPLE, 0.5, tmp_path / "cut.mp4")
    with pytest.raises(BadInput, match=r"\d+ of the 96 frames that its index lists are missing"):
        probe_video(cut)


def test_memory_stays_small_where_all_pictures_are_of_the_b_kind() -> None:
    """Low-delay HEVC: 900 frames of 1080p, which would take 2.8 GB together."""
    program = (
        "import sys; from pathlib import Path; from core.video.decode import VideoReader\n"
        "from itertools import islice\n"
        "with VideoReader(Path(sys.argv[1])) as reader:\n"
        "    print(sum(1 for _ in islice(reader.frames(), 80)))\n"
    )
    words = [sys.executable, "-c", program, str(INPUTS / "gpb1080.mp4")]
    done = subprocess.run(
        words,
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (1 << 30, 1 << 30)),
    )
    assert (done.returncode, done.stdout) == (0, "80\n"), done.stderr


@pytest.mark.parametrize("name", ["axis:2.mp4", "C:film.mp4", "-o.mp4", "%03d.mp4", "file:x.mp4", "a b,|é.mp4"])
def test_any_name_is_a_file_name(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    make_video(tmp_path / "a.mp4", every_ms(40, 5)).rename(tmp_path / name)
    monkeypatch.chdir(tmp_path)
    assert probe_video(Path(name)).info.n_frames == 5
    assert probe_video(tmp_path / name).info.n_frames == 5


def test_a_name_that_no_file_can_have_is_one_clear_error() -> None:
    with pytest.raises(BadInput, match="name cannot be used: File name too long"):
        VideoReader(Path("x" * 300))


def test_large_pictures_are_refused_from_the_header() -> None:
    with pytest.raises(BadInput, match=r"960x720 = 691,200 pixels; at most 600,000 are read") as caught:
        VideoReader(SAMPLE, max_pixels=600_000)
    assert caught.value.code == "too_many_pixels"
    VideoReader(SAMPLE, max_pixels=960 * 720).__exit__(None, None, None)
