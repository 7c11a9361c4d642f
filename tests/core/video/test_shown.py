"""Pictures as they are worked on, held against FFmpeg's own filters as Debian builds them."""

from __future__ import annotations

from fractions import Fraction
from itertools import islice
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from core.errors import BadInput
from core.video.decode import iter_frames
from core.video.factory import reopen_video
from core.video.probe import probe_video
from core.video.shown import shown_frames
from core.video.table import FrameTable
from tests.core.making_films import SAMPLE, ffmpeg_pixels, ffprobe_frames, film
from tests.core.making_videos import set_display_matrix
from tests.inputs import INPUTS

pytestmark = pytest.mark.slow

SQUARE = "scale=iw*sar:ih,setsar=1"
JOINED = "bwdif=mode=send_frame"
SMALL_SIZE = (160, 120)


def shown(path: Path, table: FrameTable) -> NDArray[np.uint8]:
    """(n, h, w, 3) every picture as shown; its size must be the one that the table states."""
    with reopen_video(path, table.info) as reader:
        pictures = np.stack([frame.rgb() for frame in shown_frames(reader.frames(), table.info)])
    assert pictures.shape == (table.info.n_frames, table.info.height, table.info.width, 3)
    return pictures


def decoded(path: Path) -> NDArray[np.uint8]:
    return np.stack([rgb for *_, rgb in iter_frames(path)])


def apart(one: NDArray[np.uint8], other: NDArray[np.uint8]) -> float:
    """Mean difference of the worst frame, grey levels."""
    assert one.shape == other.shape
    return float(np.abs(one.astype(np.int16) - other.astype(np.int16)).mean(axis=(1, 2, 3)).max())


@pytest.mark.tool("ffmpeg")
def test_pixels_are_made_square_as_ffmpeg_makes_them() -> None:
    path = INPUTS / "s360_sar43.mp4"
    table = probe_video(path)
    info = table.info
    assert (info.width, info.height, info.sample_aspect_ratio) == (480, 360, Fraction(4, 3))
    assert [row.pts for row in table.rows] == ffprobe_frames(path).pts
    assert apart(shown(path, table), ffmpeg_pixels(path, "v:0", 480, 360, SQUARE)) < 0.2
    assert decoded(path).shape[1:3] == (360, 360), "hashes are of what was decoded"


@pytest.mark.tool("ffmpeg")
@pytest.mark.parametrize(
    ("name", "aspect", "size"),
    [
        ("wide.mp4", "16/11", (232, 120)),
        ("narrow.mp4", "8/9", (142, 120)),
        ("wide.mkv", "16/11", (232, 120)),
        ("wide.ts", "59/54", (174, 120)),
        ("square.mp4", "1", SMALL_SIZE),
    ],
)
def test_every_share_of_pixels_gives_the_size_that_ffmpeg_gives(
    name: str, aspect: str, size: tuple[int, int], tmp_path: Path
) -> None:
    path = film(tmp_path / name, "-vf", f"setsar={aspect}", "-c:v", "libx264", "-preset", "ultrafast")
    table = probe_video(path)
    assert (table.info.width, table.info.height) == size
    assert apart(shown(path, table), ffmpeg_pixels(path, "v:0", *size, SQUARE)) < 0.3


@pytest.mark.tool("ffmpeg")
def test_what_is_turned_is_made_square_before(tmp_path: Path) -> None:
    made = film(tmp_path / "a.mp4", "-vf", "setsar=3/2", "-c:v", "mpeg4")
    flat = shown(made, probe_video(made))
    turned = set_display_matrix(made, 0, 1, -1, 0)
    table = probe_video(turned)
    assert (table.info.width, table.info.height, table.info.rotation_deg) == (120, 240, 90)
    assert np.array_equal(shown(turned, table), np.rot90(flat, k=-1, axes=(1, 2)))


@pytest.mark.tool("ffmpeg")
def test_fields_are_joined_as_ffmpeg_joins_them() -> None:
    path = INPUTS / "s480i.mp4"
    table = probe_video(path)
    assert (table.info.interlaced_frames, table.info.n_frames, table.info.field_order) == (48, 48, "")
    assert [row.pts for row in table.rows] == ffprobe_frames(path).pts
    ours = shown(path, table)
    assert apart(ours, ffmpeg_pixels(path, "v:0", 480, 360, JOINED)) < 0.1
    assert apart(ours, decoded(path)) > 3, "the file is combed as it was decoded"


TOP_FIRST = ("-vf", "setfield=tff", "-flags", "+ildct+ilme")
BOTTOM_FIRST = ("-vf", "setfield=bff", "-flags", "+ildct+ilme")


@pytest.mark.tool("ffmpeg")
@pytest.mark.parametrize(
    ("name", "words", "order"),
    [
        ("top.ts", (*TOP_FIRST, "-c:v", "mpeg2video"), ""),
        ("bottom.ts", (*BOTTOM_FIRST, "-c:v", "mpeg2video"), ""),
        ("bottom.mp4", (*BOTTOM_FIRST, "-c:v", "libx264", "-x264-params", "bff=1"), ""),
        ("top.mkv", ("-vf", "setfield=tff", "-c:v", "ffv1", "-field_order", "tt"), "tff"),
        ("bottom.mov", ("-vf", "setfield=bff", "-c:v", "mjpeg", "-field_order", "bb"), "bff"),
    ],
)
def test_either_field_may_be_first_and_frame_or_container_may_say_so(
    name: str, words: tuple[str, ...], order: str, tmp_path: Path
) -> None:
    path = film(tmp_path / name, *words)
    table = probe_video(path)
    assert (table.info.interlaced_frames, table.info.field_order) == (48, order)
    filters = f"setfield={order},{JOINED}" if order else JOINED
    other = JOINED.replace("bwdif=", "bwdif=parity=bff:" if "top" in name else "bwdif=parity=tff:")
    ours = shown(path, table)
    assert apart(ours, ffmpeg_pixels(path, "v:0", *SMALL_SIZE, filters)) < 0.5
    assert apart(ours, ffmpeg_pixels(path, "v:0", *SMALL_SIZE, other)) > 1


@pytest.mark.tool("ffmpeg")
def test_frames_that_are_whole_pass_between_interlaced_ones(tmp_path: Path) -> None:
    """Two recordings, one of each kind, in one file."""
    whole = film(tmp_path / "whole.ts", "-c:v", "mpeg2video")
    fields = film(tmp_path / "fields.ts", *TOP_FIRST, "-c:v", "mpeg2video")
    path = tmp_path / "both.ts"
    path.write_bytes(whole.read_bytes() + fields.read_bytes())
    table = probe_video(path)
    assert (table.info.n_frames, table.info.interlaced_frames) == (96, 48)
    ours, plain = shown(path, table), decoded(path)
    assert np.array_equal(ours[:48], plain[:48])
    assert apart(ours[48:], plain[48:]) > 1


def test_what_needs_nothing_is_handed_on_bit_for_bit() -> None:
    table = probe_video(SAMPLE)
    with reopen_video(SAMPLE, table.info) as reader:
        for frame in islice(shown_frames(reader.frames(), table.info), 5):
            assert np.array_equal(frame.rgb(), frame.decoded.rgb())


@pytest.mark.tool("ffmpeg")
def test_fields_and_pixels_of_dv(tmp_path: Path) -> None:
    path = film(tmp_path / "a.dv", "-vf", "scale=720:576,setdar=4/3", "-pix_fmt", "yuv420p", "-r", "25")
    table = probe_video(path)
    info = table.info
    assert (info.width, info.height, info.sample_aspect_ratio) == (768, 576, Fraction(16, 15))
    assert info.interlaced_frames == info.n_frames
    expected = ffmpeg_pixels(path, "v:0", 768, 576, f"{JOINED},{SQUARE}")
    assert apart(shown(path, table), expected) < 0.3


@pytest.mark.tool("ffmpeg")
def test_pixels_so_wide_that_the_picture_is_too_large_are_refused(tmp_path: Path) -> None:
    path = film(tmp_path / "a.mp4", "-vf", "setsar=100", "-c:v", "mpeg4")
    with pytest.raises(BadInput, match="16000x120") as caught:
        probe_video(path, max_pixels=1_000_000)
    assert caught.value.code == "too_many_pixels"
