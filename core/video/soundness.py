"""Which decoded frames depend on nothing broken, and what was lost.

Decoders say little: some errors raise, some mark a frame, some only make a packet give no picture. So every packet
gets a number in the order of decoding, its frame carries that number out of the decoder, and what never comes out is
missed. From a broken packet on, all frames decoded after it are left out up to the next keyframe, because they may
refer to it; frames decoded before it stay, though they may be shown later.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Generic, Protocol, SupportsBytes, TypeVar

REORDERING = 34
"""Packets after which a frame that did not come out is lost: a decoder holds 16 frames back at most (H.264 annex A,
H.265 annex A), each of two fields, which may be packets of their own."""
_TINY = 16
_SKIPPING = frozenset({"mpeg4", "msmpeg4v1", "msmpeg4v2", "msmpeg4v3", "h263", "flv", "wmv1", "wmv2"})
"""Codecs that write a frame equal to the one before as a packet of some bytes, which gives no picture."""


@dataclass(frozen=True)
class Sent:
    """A packet on its way through the decoder."""

    number: int
    """In the order of decoding."""
    pts: int | None


@dataclass
class Loss:
    """Frames that were left out between two sound ones."""

    pts: int | None
    """Time of the first packet that broke; None when it has none."""
    after: int
    """Number of sound frames shown before it."""
    causes: list[str] = field(default_factory=list)
    frames: int = 0
    """Left out, those that only refer to a broken one included."""


class Packet(SupportsBytes, Protocol):
    """What is asked of a packet; PyAV's has it."""

    @property
    def size(self) -> int:
        """Bytes."""

    @property
    def is_discard(self) -> bool:
        """Whether an edit list cuts it away."""


class Frame(Protocol):
    """What is asked of a decoded frame; PyAV's has it."""

    @property
    def opaque(self) -> object:
        """Its packet as a `Sent`, None where the decoder lost it."""

    @property
    def pts(self) -> int | None:
        """Presentation time."""

    @property
    def key_frame(self) -> bool:
        """Whether it refers to no other frame."""

    @property
    def is_corrupt(self) -> bool:
        """Whether the decoder concealed an error in it."""

    @property
    def interlaced_frame(self) -> bool:
        """Whether it was made of two fields."""


def number_of(frame: Frame) -> int | None:
    """Number of the packet that a frame came of; None where the decoder lost it."""
    return frame.opaque.number if isinstance(frame.opaque, Sent) else None


AnyFrame = TypeVar("AnyFrame", bound=Frame)


def shows_picture(codec: str, packet: Packet) -> bool:
    """Whether a decoder is to give a picture for a packet: not for parts cut away by an edit list, for frames that
    others refer to but nobody sees (VP8: RFC 6386, 9.1; VP9: bitstream specification, 6.2), nor for skipped ones."""
    if packet.is_discard:
        return False
    if codec in _SKIPPING:
        return int(packet.size) > _TINY
    if codec not in ("vp8", "vp9"):
        return True
    data = bytes(packet)
    if codec == "vp8":
        return bool(data[0] & 0x10)
    profile = data[0] >> 5 & 1 | data[0] >> 3 & 2
    bits = data[0] << (5 if profile == 3 else 4)  # from show_existing_frame on
    several = data[-1] & 0xE0 == 0xC0  # a superframe ends with the frame that is seen
    return several or bool(bits & 0x80) or bool(bits & 0x20)


class SoundFrames(Generic[AnyFrame]):
    """Takes the packets sent and the frames that come out; hands on the sound frames in the order shown.

    Frames are held only while a packet that was decoded before theirs is still in the decoder: at most `REORDERING`,
    and none where frames are shown in the order of decoding, whatever kind of pictures they are.
    """

    def __init__(self) -> None:
        self.losses: list[Loss] = []
        self._pending: dict[int, Sent] = {}
        """Sent and not out yet, in the order of decoding."""
        self._held: deque[tuple[int, AnyFrame]] = deque()
        self._broken: dict[int, tuple[Sent, str]] = {}
        """Broken packets that no sound keyframe has come after, with the cause."""
        self._leading: set[int] = set()
        """Broken packets shown before the first sound frame and decoded after it."""
        self._first: Sent | None = None
        """Packet of the first sound frame. Recordings begin in the middle of a group; what cannot decode there was
        never lost."""
        self._shown = 0
        self._latest: deque[int | None] = deque(maxlen=REORDERING)
        """Times of the latest frames handed on: one that is missed may have been shown before them."""

    def sent(self, packet: Sent) -> None:
        """A packet that shows a picture is about to be decoded."""
        self._pending[packet.number] = packet

    def broke(self, packet: Sent) -> None:
        """A packet does not decode. Everything decoded before it has come out: what did not is lost."""
        self._pending.pop(packet.number, None)
        self.ended()
        self._break(packet, "a packet does not decode")

    def came(self, frame: AnyFrame, duration: Fraction, *, broken: bool = False) -> None:
        """A frame came out.

        Args:
            frame: of FFmpeg.
            duration: what a frame of this stream lasts, in units of pts.
            broken: there is more than the frame's own mark to tell that it is.
        """
        known = number_of(frame)
        number = next(iter(self._pending), 0) if known is None else known
        packet = self._pending.pop(number, Sent(number, frame.pts))
        if frame.interlaced_frame:
            self._drop_second_field(packet, duration)
        self._miss(self._overdue(number, frame))
        if frame.is_corrupt or broken:
            self._break(packet, "errors in a picture")
        elif self._first is None and (frame.key_frame or not self._broken):
            self._begin(packet)
        self._held.append((number, frame))

    def ended(self) -> None:
        """The decoder is empty: nothing more comes out."""
        self._miss(list(self._pending))

    def sound(self) -> Iterator[AnyFrame]:
        """The frames of which it is known by now that they are sound."""
        while self._held:
            number, frame = self._held[0]
            if self._pending and next(iter(self._pending)) < number:
                return  # not known yet
            self._held.popleft()
            if number in self._leading:
                continue
            if frame.key_frame and number not in self._broken:
                self._broken = {n: broken for n, broken in self._broken.items() if n > number}
            elif any(n <= number for n in self._broken):
                if number not in self._broken and any(self._counts(n) for n in self._broken if n < number):
                    self.losses[-1].frames += 1
                continue
            if self._first is not None:
                self._shown += 1
                self._latest.append(frame.pts)
                if self.losses and _later(self.losses[-1].pts, frame.pts):
                    self.losses[-1].after = self._shown
                yield frame

    def _overdue(self, number: int, frame: AnyFrame) -> list[int]:
        """Packets whose frame can no longer come after this one."""
        newest = max(number, next(reversed(self._pending), number))
        return [
            n
            for n, packet in self._pending.items()
            # Whatever was decoded before a keyframe is shown before it.
            if (frame.key_frame and n < number and not _later(packet.pts, frame.pts)) or newest - n > REORDERING
        ]

    def _drop_second_field(self, first: Sent, duration: Fraction) -> None:
        """Two fields may come as two packets; the frame of both carries the number of the first."""
        second = self._pending.get(first.number + 1)
        if second is None or first.pts is None:
            return
        if second.pts is None or first.pts <= second.pts < first.pts + duration * 3 / 4:
            del self._pending[second.number]

    def _miss(self, numbers: list[int]) -> None:
        """Packets that gave no picture."""
        for number in numbers:
            packet = self._pending.pop(number)
            if self._first is not None and not _later(self._first.pts, packet.pts):
                self._break(packet, "no picture came of a packet")

    def _begin(self, first: Sent) -> None:
        """The first sound frame came out, maybe after broken ones that were decoded after it.

        Of these, the ones shown before it lead from frames that the recording lacks: they were never lost, and nothing
        refers to them.
        """
        self._first = first
        early, self._broken = self._broken, {n: broken for n, broken in self._broken.items() if not self._counts(n)}
        for number, (packet, cause) in early.items():
            if self._counts(number) and _later(first.pts, packet.pts):
                self._leading.add(number)
            elif self._counts(number):
                self._break(packet, cause)

    def _break(self, packet: Sent, cause: str) -> None:
        if self._counts(packet.number):
            if not any(self._counts(n) for n in self._broken):
                shown_later = sum(_later(pts, packet.pts) for pts in self._latest)
                self.losses.append(Loss(packet.pts, self._shown - shown_later))
            loss = self.losses[-1]
            loss.frames += 1
            if cause not in loss.causes:
                loss.causes.append(cause)
        self._broken[packet.number] = (packet, cause)

    def _counts(self, number: int) -> bool:
        return self._first is not None and number > self._first.number


def _later(pts: int | None, than: int | None) -> bool:
    """Whether a time is known to be after another one."""
    return pts is not None and than is not None and pts > than
