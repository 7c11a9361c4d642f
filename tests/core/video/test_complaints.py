"""What a decoder says of its pictures, and which of it means damage."""

from __future__ import annotations

import logging
from itertools import islice
from pathlib import Path

import av
import av.logging
import numpy as np
import pytest

from core.video.complaints import Complaints, listened
from core.video.decode import iter_frames
from core.video.probe import probe_video
from tests.core.making_films import film
from tests.inputs import INPUTS

EARLY_END = (av.logging.WARNING, "mjpeg", "EOI missing, emulating\n")
BAD_CODE = (av.logging.ERROR, "mjpeg", "error y=17 x=19\n")


def damaged(*said: list[tuple[int, str, str]]) -> tuple[int, ...]:
    complaints = Complaints()
    for number, texts in enumerate(said):
        complaints.heard(number, texts)
        complaints.came(number, number)
    return complaints.frames()


def test_errors_and_some_warnings_are_damage() -> None:
    assert damaged([], [EARLY_END], [], [BAD_CODE], []) == (1, 3)
    assert damaged([], [(av.logging.WARNING, "mjpeg", "overread 8\n")], []) == ()
    assert damaged([], [], []) == ()


def test_what_is_said_of_most_pictures_is_how_they_are_written() -> None:
    assert damaged([EARLY_END], [EARLY_END], [EARLY_END, BAD_CODE], [EARLY_END]) == (2,)
    other = (av.logging.ERROR, "mjpeg", "error y=3 x=200\n")
    assert damaged([BAD_CODE], [other], [BAD_CODE], [other], []) == (), "numbers do not make it another message"


def test_a_frame_without_a_number_is_of_the_packet_before_it() -> None:
    complaints = Complaints()
    complaints.heard(7, [BAD_CODE])
    complaints.came(0, None)
    complaints.came(1, None)
    complaints.came(2, None)
    assert complaints.frames() == (0,)


def test_nothing_is_left_switched_on(caplog: pytest.LogCaptureFixture) -> None:
    before = av.logging.get_level(), av.logging.get_skip_repeated()
    with caplog.at_level(logging.DEBUG):
        for _ in range(2):
            with listened() as said:
                av.logging.log(av.logging.ERROR, "test", "twice the same")
            assert [text for _, _, text in said] == ["twice the same"]
    assert (av.logging.get_level(), av.logging.get_skip_repeated()) == before
    assert caplog.records == []


@pytest.mark.parametrize(("name", "frames"), [("mjpeg_half.avi", range(20, 25)), ("corrupt_mid.avi", range(23, 24))])
def test_pictures_that_decode_to_something_else_are_named_and_stay(name: str, frames: range) -> None:
    table = probe_video(INPUTS / name)
    assert table.info.damaged_pictures == tuple(frames)
    assert (table.info.n_frames, table.info.damage, table.info.truncated) == (48, (), False)


def test_they_are_the_ones_that_look_unlike_their_neighbours() -> None:
    """Half of the picture is one grey."""
    flat = [i for i, _, _, rgb in iter_frames(INPUTS / "mjpeg_half.avi") if np.ptp(rgb[-40:].astype(int)) < 30]
    assert flat == list(range(20, 25))


@pytest.mark.tool("ffmpeg")
@pytest.mark.parametrize(
    ("name", "codec"),
    [
        ("a.gif", ()),
        ("a.avi", ("-c:v", "msmpeg4v2", "-g", "12")),
        ("a.mkv", ("-c:v", "ffv1", "-level", "3", "-slicecrc", "1", "-slices", "4", "-g", "12")),
    ],
)
def test_what_refers_to_a_picture_that_is_complained_of_is_left_out(
    name: str, codec: tuple[str, ...], tmp_path: Path
) -> None:
    path = film(tmp_path / name, *codec)
    whole = {row.pts: row.sha256 for row in probe_video(path).rows}
    with av.open(str(path)) as container:
        packet = next(islice((one for one in container.demux(video=0) if one.size), 26, None))
        assert packet.pos is not None
        at = path.read_bytes().index(bytes(packet)[-200:-100]) if name == "a.mkv" else packet.pos + packet.size // 3
    data = bytearray(path.read_bytes())
    data[at : at + 12] = bytes(np.random.default_rng(0).integers(0, 256, 12, np.uint8))
    path.write_bytes(data)
    part = probe_video(path, allow_truncated=True)
    assert "errors in a picture" in part.info.damage[0]
    assert 12 <= part.info.n_frames < 48
    assert all(whole[row.pts] == row.sha256 for row in part.rows)


@pytest.mark.tool("ffmpeg")
@pytest.mark.parametrize("suffix", ["avi", "mov", "mkv", "mjpeg"])
def test_pictures_whose_writer_leaves_the_end_mark_out_are_sound(suffix: str, tmp_path: Path) -> None:
    path = film(tmp_path / f"a.{suffix}", "-c:v", "mjpeg")
    assert probe_video(path).info.damaged_pictures == ()
    path.write_bytes(path.read_bytes().replace(b"\xff\xd9", b"\x00\x00"))
    info = probe_video(path, allow_truncated=True).info
    assert (info.n_frames, info.damaged_pictures) == (48, ())
