"""Packets in, frames out: what is handed on when, with decoders that say little."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import pytest

from core.video.soundness import REORDERING, Sent, SoundFrames, shows_picture


@dataclass
class Frame:
    number: int | None
    pts: int | None
    key_frame: bool = False
    is_corrupt: bool = False
    interlaced_frame: bool = False

    @property
    def opaque(self) -> Sent | None:
        return None if self.number is None else Sent(self.number, self.pts)


class Decoder:
    """Sends packets and frames to `SoundFrames` and keeps what it hands on."""

    def __init__(self) -> None:
        self.sound: SoundFrames[Frame] = SoundFrames()
        self.shown: list[int | None] = []

    def send(self, *pts: int) -> None:
        number = getattr(self, "number", -1)
        for one in pts:
            number += 1
            self.sound.sent(Sent(number, one))
        self.number = number

    def come(self, *frames: Frame) -> None:
        for frame in frames:
            self.sound.came(frame, Fraction(1))
            self.shown += [one.number for one in self.sound.sound()]

    def end(self) -> list[tuple[int, int]]:
        self.sound.ended()
        self.shown += [one.number for one in self.sound.sound()]
        return [(loss.after, loss.frames) for loss in self.sound.losses]


def test_frames_in_the_order_of_decoding_are_handed_on_at_once() -> None:
    decoder = Decoder()
    for number in range(5):
        decoder.send(number)
        decoder.come(Frame(number, number, key_frame=number == 0))
        assert decoder.shown == list(range(number + 1))
    assert decoder.end() == []


def test_a_frame_waits_for_what_was_decoded_before_it() -> None:
    decoder = Decoder()
    decoder.send(0, 3, 1, 2)
    decoder.come(Frame(0, 0, key_frame=True), Frame(2, 1), Frame(3, 2))
    assert decoder.shown == [0]
    decoder.come(Frame(1, 3))
    assert decoder.shown == [0, 2, 3, 1]
    assert decoder.end() == []


def test_a_broken_frame_takes_those_along_that_were_decoded_after_it() -> None:
    decoder = Decoder()
    decoder.send(0, 3, 1, 2, 4)
    decoder.come(Frame(0, 0, key_frame=True), Frame(2, 1), Frame(3, 2), Frame(1, 3, is_corrupt=True))
    decoder.come(Frame(4, 4, key_frame=True))
    assert decoder.shown == [0, 4]
    assert decoder.end() == [(1, 3)]


def test_a_frame_of_which_the_decoder_complains_counts_as_broken() -> None:
    decoder = Decoder()
    decoder.send(0, 1, 2)
    decoder.come(Frame(0, 0, key_frame=True))
    decoder.sound.came(Frame(1, 1), Fraction(1), broken=True)
    decoder.come(Frame(2, 2))
    decoder.send(3)
    decoder.come(Frame(3, 3, key_frame=True))
    assert decoder.shown == [0, 3]
    assert decoder.end() == [(1, 2)]


def test_a_frame_that_never_comes_is_missed_after_the_longest_delay_a_decoder_has() -> None:
    decoder = Decoder()
    decoder.send(0, 1)
    decoder.come(Frame(0, 0, key_frame=True))
    for number in range(2, REORDERING + 3):
        decoder.send(number)
        decoder.come(Frame(number, number))
    assert decoder.shown == [0]
    assert decoder.sound.losses[0].after == 1
    decoder.send(number + 1)
    decoder.come(Frame(number + 1, number + 1, key_frame=True))
    assert decoder.shown == [0, number + 1]
    assert decoder.end() == [(1, REORDERING + 2)]


def test_broken_frames_that_lead_to_the_first_keyframe_were_never_lost() -> None:
    """A recording that begins in an open group: the frames shown before its first keyframe refer to what it lacks."""
    decoder = Decoder()
    decoder.send(3, 1, 2, 4)
    decoder.come(Frame(1, 1, is_corrupt=True), Frame(2, 2, is_corrupt=True), Frame(0, 3, key_frame=True), Frame(3, 4))
    assert decoder.shown == [0, 3]
    assert decoder.end() == []


def test_a_broken_frame_that_comes_out_before_the_first_keyframe_is_lost_when_it_is_shown_after_it() -> None:
    decoder = Decoder()
    decoder.send(0, 1, 2, 3)
    decoder.come(Frame(1, 1, is_corrupt=True), Frame(0, 0, key_frame=True), Frame(2, 2), Frame(3, 3, key_frame=True))
    assert decoder.shown == [0, 3]
    assert decoder.end() == [(1, 2)]


def test_what_cannot_decode_before_the_first_keyframe_was_never_lost() -> None:
    decoder = Decoder()
    decoder.send(0, 1, 2)
    decoder.come(Frame(0, 0, is_corrupt=True))
    decoder.send(6, 4, 5)
    decoder.come(Frame(3, 6, key_frame=True))
    assert decoder.shown == [3]
    assert decoder.end() == []


def test_two_fields_in_two_packets_are_one_frame() -> None:
    decoder = Decoder()
    for number in range(0, 20, 2):
        decoder.send(number, number + 0)
        decoder.come(Frame(number, number, key_frame=number == 0, interlaced_frame=True))
    assert decoder.shown == list(range(0, 20, 2))
    assert decoder.end() == []


def test_a_decoder_that_carries_no_numbers_is_believed_to_keep_the_order() -> None:
    decoder = Decoder()
    decoder.send(0, 1)
    decoder.come(Frame(None, 0, key_frame=True), Frame(None, 1))
    assert len(decoder.shown) == 2
    assert decoder.end() == []


class Packet(bytes):
    is_discard = False

    @property
    def size(self) -> int:
        return len(self)


@pytest.mark.parametrize(
    ("codec", "data", "shown"),
    [
        ("vp8", b"\x10", True),
        ("vp8", b"\x00", False),
        ("vp9", b"\x80\x00", False),  # a hidden keyframe
        ("vp9", b"\x86\x00", True),
        ("vp9", b"\x88\x00", True),  # an earlier frame, shown now
        ("vp9", b"\x80\x00\xc0", True),  # with the frame that is seen behind it
        ("mpeg4", bytes(7), False),
        ("mpeg4", bytes(40), True),
        ("h264", bytes(7), True),
    ],
)
def test_packets_without_a_picture_of_their_own_are_known(codec: str, data: bytes, shown: bool) -> None:
    assert shows_picture(codec, Packet(data)) is shown


def test_a_packet_that_an_edit_list_cuts_away_shows_nothing() -> None:
    packet = Packet(b"\x10")
    packet.is_discard = True
    assert not shows_picture("h264", packet)
