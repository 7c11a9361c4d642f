"""What is read as a video is what the documentation and the messages say."""

from __future__ import annotations

import re
from pathlib import Path

import av
import pytest

from core.errors import BadInput
from core.video.formats import FORMAT_WHITELIST, PICTURE_CODECS, TIMELESS, VIDEO_FORMATS
from core.video.probe import probe_video

PAGE = Path(__file__).parents[3] / "docs" / "how-to" / "own-video.md"


def test_the_page_lists_every_format() -> None:
    page = PAGE.read_text(encoding="utf-8").partition("## What is read as a video")[2].partition("\n## ")[0]
    rows = re.findall(r"^\| (.+?) \| (`.+?`) \| (.+?) \|$", page, re.MULTILINE)
    times = {True: "made from a rate", False: "in the file"}
    listed = [(one.title, ", ".join(f"`.{s}`" for s in one.suffixes), times[one.timeless]) for one in VIDEO_FORMATS]
    assert rows == listed


def test_the_message_lists_every_format(tmp_path: Path) -> None:
    (tmp_path / "a.mp4").write_bytes(b"no video" * 100)
    with pytest.raises(BadInput) as caught:
        probe_video(tmp_path / "a.mp4")
    assert all(one.title in caught.value.message for one in VIDEO_FORMATS)
    assert "a folder or zip of pictures" in caught.value.message


def test_every_demuxer_is_one_of_ffmpeg_and_stands_in_one_format() -> None:
    names = [name for one in VIDEO_FORMATS for name in one.demuxers]
    assert len(set(names)) == len(names)
    assert set(names) <= set(FORMAT_WHITELIST.split(","))
    assert all(set(one.demuxers) & av.formats_available for one in VIDEO_FORMATS)
    assert {"h264", "hevc", "mjpeg", "mpjpeg", "obu"} <= TIMELESS < set(names)
    assert not {"hls", "concat", "image2", "dash", "rtsp"} & set(FORMAT_WHITELIST.split(",")), "they open other files"


def test_every_picture_has_a_decoder() -> None:
    assert {av.Codec(name, "r").type for name in PICTURE_CODECS.values()} == {"video"}
