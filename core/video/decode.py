"""The only place that decodes video. Every frame number of this project counts what comes out here.

Frames come in presentation order, turned as the rotation flag asks, as RGB24. The decoder runs on one
thread: only then does it report every concealed error, and the result is the same on every machine.
After damage, frames are dropped up to the next keyframe, because they may refer to what is broken. Where every
picture stands for itself, one that the decoder complains of is kept and named (`VideoReader.damaged`).
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, cast

import av
import numpy as np
from av.codec.context import Flags
from av.sidedata.sidedata import Type as SideDataType
from numpy.typing import NDArray

from core.errors import BadInput
from core.video.clock import FALLBACK_RATE, PresentationClock
from core.video.complaints import Complaints, listened
from core.video.container import film_of, open_container, require_pixels, time_base_of
from core.video.formats import TIMELESS
from core.video.limits import MAX_FRAME_PIXELS
from core.video.orientation import Orientation, square_width
from core.video.soundness import Loss, Sent, SoundFrames, number_of, shows_picture
from core.video.table import TimesFrom

if TYPE_CHECKING:
    from av.packet import Packet
    from av.sidedata.sidedata import SideDataContainer
    from av.video.stream import VideoStream

_DECLARING_FORMATS = frozenset({"mov", "matroska", "avi", "flv", "asf"})
"""Containers whose header states a duration; elsewhere it is estimated and says nothing about damage."""
_INDEXED_FORMATS = frozenset({"mov", "avi"})
"""Containers whose index lists every packet. (Its count stands in the header too, but that of AVI counts the frames
which a recorder dropped, and that of MP4 those which an edit list cuts away.)"""

_UNMARKED = frozenset({"mjpeg", "rawvideo", "ffv1", "huffyuv", "ffvhuff", "utvideo", "v210", "qtrle"})
"""Codecs that do not mark interlaced pictures; there the container's field order counts."""
_COMPLAINING = frozenset({"gif", "ffv1", "msmpeg4v1", "msmpeg4v2", "msmpeg4v3"})
"""Codecs whose pictures refer to others and whose decoders tell of damage in messages only. (Those of H.264, HEVC and
MPEG mark their frames, and report errors of sound streams, too.)"""
_FIELD_ORDERS = {2: "tff", 3: "bff", 4: "bff", 5: "tff"}
"""FFmpeg's AVFieldOrder, as its filter `setfield` names the field that is shown first."""
_SANE_RATES = (Fraction(1, 100), Fraction(1000))
"""Frames per second outside of these in the header of a raw stream are no rate."""

_JOIN_MARK = 3
"""A packet that is marked as cut off because another recording follows is one of the last so many before it."""


@dataclass(frozen=True)
class DecodedFrame:
    """One frame as decoded; `rgb` converts it."""

    index: int
    """Counts decoded frames from 0."""
    pts: int
    """Presentation time in units of the reader's time base, strictly increasing."""
    keyframe: bool
    coded: av.VideoFrame = field(repr=False)
    """FFmpeg's frame."""
    orientation: Orientation = field(repr=False)

    def rgb(self) -> NDArray[np.uint8]:
        """(h, w, 3) uint8 RGB, turned; not deinterlaced and without square pixels (`core.video.shown`)."""
        return self.orientation.apply(np.asarray(self.coded.to_ndarray(format="rgb24"), np.uint8))


class VideoReader:
    """A video opened for one pass. Use as a context manager; iterate `frames()` once.

    Args:
        path: the file.
        stream: number of the stream to read; None takes the film (`core.video.container.choose_film`).
        fps: frames per second of a file that holds no times of its own; `BadInput` for any other.
        max_pixels: pictures with more are refused, from the header.

    Attributes:
        streams: all video streams of the file.
        stream_index: number of the one that is read.
        time_base: seconds per unit of `pts`.
        declared_rate: frames per second as the container states them; None when it does not.
        declared_frames: 0 when unknown.
        declared_s: length as the header states it; None where it states none.
        codec: name of the codec.
        sample_aspect_ratio: width / height of a pixel as coded.
        times_from: where the times of the frames come from.
        interlaced_frames: number of frames so far that are made of two fields.
        field_order: ``tff`` or ``bff`` where the container says which field is first and the frames do not; else empty.
        faults: what was found broken in the file so far, in words.
        orientation: known after the first frame.
    """

    def __init__(
        self,
        path: Path,
        stream: int | None = None,
        *,
        fps: float | Fraction | None = None,
        max_pixels: int = MAX_FRAME_PIXELS,
    ) -> None:
        self.name = path.name
        self._max_pixels = max_pixels
        self._container = open_container(path)
        try:
            self._stream, self.streams = film_of(self._container, path.name, stream)
            codec = self._stream.codec_context
            self.sample_aspect_ratio = Fraction(self._stream.sample_aspect_ratio or 1)
            self._require_pixels(codec.width, codec.height)
            self._format = set(self._container.format.name.split(","))
            self._made_rate, self.times_from = self._made_up_rate(fps)
        except BadInput:
            self._container.close()
            raise
        self._stream.thread_type = "NONE"
        codec.flags |= Flags.copy_opaque  # a frame then carries what its packet was given
        self.stream_index = int(self._stream.index)
        self._time_base = time_base_of(self._stream)
        self.time_base = 1 / self._made_rate if self._made_rate else self._time_base
        rate = self._stream.average_rate
        self.declared_rate = Fraction(rate) if rate else None
        self.declared_frames = int(self._stream.frames)
        self.codec = str(codec.name)
        self.field_order = _FIELD_ORDERS.get(int(codec.field_order), "") if self.codec in _UNMARKED else ""
        self.interlaced_frames = 0
        self._stands_alone = bool(codec.codec.intra_only)
        self._complaints = Complaints() if self._stands_alone or self.codec in _COMPLAINING else None
        self.faults: list[str] = []
        self.orientation = Orientation()
        self._clock = PresentationClock(self._time_base, self.declared_rate)
        self._sound: SoundFrames[av.VideoFrame] = SoundFrames()
        self._first_s: Fraction | None = None
        self._end_s = Fraction(0)
        """Of all streams."""
        self._last_s = Fraction(0)
        """Start of the latest packet of the film."""
        self._video_end = 0
        self._chunk = -1
        self.declared_s = self._declared_s()
        self._listed = len(self._stream.index_entries) if self._format & _INDEXED_FORMATS else 0

    def __enter__(self) -> VideoReader:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._container.close()

    @property
    def losses(self) -> list[Loss]:
        """Frames that were left out so far, because they or one that they refer to are broken."""
        return self._sound.losses

    @property
    def repaired_times(self) -> int:
        """Frames so far whose time was missing or not after the one before."""
        return self._clock.repaired

    @property
    def joined(self) -> list[int]:
        """Frames so far at which the stamps start again: the file was joined from several recordings."""
        return self._clock.joined

    @property
    def damaged(self) -> tuple[int, ...]:
        """After the last frame: those of the frames whose decoder complained of their picture."""
        return self._complaints.frames() if self._complaints and self._stands_alone else ()

    def frames(self) -> Iterator[DecodedFrame]:
        """Frames in presentation order; damaged ones are left out and noted in `losses` and `faults`."""
        shape = None
        for index, frame in enumerate(self._sound_frames()):
            if shape is None:
                shape = (frame.width, frame.height)
                self.orientation = self._read_orientation(frame)
            elif shape != (frame.width, frame.height):
                raise BadInput(
                    f"the frame size of '{self.name}' changes at frame {index}",
                    code="frame_size_changes",
                    where="video",
                )
            if self._made_rate:
                pts, duration = index, 1
            else:
                duration = int(frame.duration or 0)
                pts = self._clock.time(self._stamp(frame), duration)
            self._video_end = pts + duration
            self.interlaced_frames += bool(frame.interlaced_frame or self.field_order)
            if self._complaints and self._stands_alone:
                self._complaints.came(index, number_of(frame))
            yield DecodedFrame(index, pts, bool(frame.key_frame), frame, self.orientation)
        self._clock.finish()

    def _stamp(self, frame: av.VideoFrame) -> int | None:
        """Time of a frame as the file has it; None when it has none."""
        if "avi" not in self._format:
            return None if frame.pts is None else int(frame.pts)
        # AVI only counts chunks in the order of decoding, which is as good as the time of the frame that comes out
        # meanwhile. The last frames come out when no chunk is left.
        self._chunk = int(frame.dts) if frame.dts is not None else self._chunk + 1
        return self._chunk

    def _sound_frames(self) -> Iterator[av.VideoFrame]:
        """Frames that depend on nothing broken."""
        duration = 1 / ((self.declared_rate or FALLBACK_RATE) * self._time_base)
        for frame in self._decode():
            if frame is not None:
                self._require_pixels(frame.width, frame.height)
                self._sound.came(frame, duration, broken=self._is_complained_of(frame))
            yield from self._sound.sound()

    def _is_complained_of(self, frame: av.VideoFrame) -> bool:
        """Whether the decoder complained of a frame that others refer to."""
        return self._complaints is not None and not self._stands_alone and self._complaints.of(number_of(frame))

    def _decode(self) -> Iterator[av.VideoFrame | None]:
        """Frames of the stream as the decoder gives them; None once it holds none back any more."""
        decoder = self._stream.codec_context
        number = -1
        for number, (packet, whole) in enumerate(self._checked_packets()):
            sent = Sent(number, packet.pts)
            if not whole:
                self._fault("a packet that is cut off")
            else:
                if shows_picture(self.codec, packet):
                    self._sound.sent(sent)
                # PyAV finds it by the object's address, over all readers of the process: a small number is one object
                # for all of them, and the frames of another reader would take it along when they are let go.
                packet.opaque = sent
                try:
                    frames = self._decoded(packet, number)
                except av.error.FFmpegError:
                    pass
                else:
                    yield from frames
                    continue
            yield from self._drained()
            decoder.flush_buffers()
            self._sound.broke(sent)
            yield None
        yield from self._drained()
        self._sound.ended()
        yield None
        if number + 1 < self._listed:
            self._fault(f"{self._listed - number - 1} of the {self._listed} frames that its index lists are missing")

    def _decoded(self, packet: Packet[VideoStream], number: int) -> list[av.VideoFrame]:
        """Frames that come out for a packet."""
        if self._complaints is None:
            return list(packet.decode())
        with listened() as said:
            frames = list(packet.decode())
        self._complaints.heard(number, said)
        return frames

    def _drained(self) -> list[av.VideoFrame]:
        """What the decoder still holds."""
        try:
            return list(self._stream.codec_context.decode(None))
        except av.error.FFmpegError:
            return []

    def _checked_packets(self) -> Iterator[tuple[Packet[VideoStream], bool]]:
        """Packets, and whether each is whole.

        Transport streams number their pieces. Where two recordings meet the numbers do not go on, and one of the last
        packets of the first one is marked as cut off, which it is not.
        """
        waiting: deque[Packet[VideoStream]] = deque()
        for packet in self._packets():
            if waiting and _starts_again(packet, waiting[-1]):
                yield from ((one, True) for one in waiting)
                waiting.clear()
            waiting.append(packet)
            while waiting and (not waiting[0].is_corrupt or len(waiting) > _JOIN_MARK):
                one = waiting.popleft()
                yield one, not one.is_corrupt
        yield from ((one, not one.is_corrupt) for one in waiting)

    def _packets(self) -> Iterator[Packet[VideoStream]]:
        """Packets of the stream that hold something; those of all streams count towards how far the file reaches."""
        packets = self._container.demux()
        while True:
            try:
                packet = next(packets)
            except StopIteration:
                return
            except av.error.FFmpegError:
                # What separates the pictures of this format is missing after the last one.
                if "mpjpeg" not in self._format:
                    self._fault("data missing before the end")
                return
            if packet.pts is not None and packet.time_base:
                start = packet.pts * Fraction(packet.time_base)
                self._first_s = start if self._first_s is None else min(self._first_s, start)
                self._end_s = max(self._end_s, start + (packet.duration or 0) * Fraction(packet.time_base))
                if packet.stream_index == self.stream_index:
                    self._last_s = max(self._last_s, start)
            # An empty packet would tell the decoder that nothing follows.
            if packet.stream_index == self.stream_index and packet.size:
                yield cast("Packet[VideoStream]", packet)  # by its number

    def _require_pixels(self, width: int, height: int) -> None:
        require_pixels(square_width(width, self.sample_aspect_ratio), height, self.name, self._max_pixels)

    def _made_up_rate(self, fps: float | Fraction | None) -> tuple[Fraction | None, TimesFrom]:
        """The rate from which the times are made, and where it comes from; None where the file holds times."""
        if not self._format & TIMELESS:
            if fps is not None:
                raise BadInput(
                    f"'{self.name}' holds the times of its frames; input.fps is for raw streams and pictures",
                    code="fps_not_needed",
                    where="input.fps",
                )
            return None, "file"
        if fps is not None:
            return Fraction(str(fps)), "given"
        stated = self._stream.codec_context.framerate
        if stated and _SANE_RATES[0] <= Fraction(stated) <= _SANE_RATES[1]:
            return Fraction(stated), "stream"
        return FALLBACK_RATE, "assumed"

    def _fault(self, what: str) -> None:
        if what not in self.faults:
            self.faults.append(what)

    def _read_orientation(self, frame: av.VideoFrame) -> Orientation:
        # PyAV's stubs give the mapping of side data the type of one of its values.
        sides = cast("SideDataContainer", frame.side_data)
        matrix = sides.get(SideDataType.DISPLAYMATRIX)
        return Orientation.from_display_matrix(bytes(matrix)) if matrix is not None else Orientation()

    def missing_at_end_s(self, spacing_s: Fraction) -> Fraction:
        """After the last frame: seconds that the header promises and the file does not hold; 0 when unknown.

        Args:
            spacing_s: what a frame lasts; not all containers say so of the last one.
        """
        if self.declared_s is None:
            return Fraction(0)
        end_s = max(self._end_s, self._last_s + spacing_s)
        return max(Fraction(0), self.declared_s - (end_s - (self._first_s or Fraction(0))))

    def _declared_s(self) -> Fraction | None:
        declared = self._container.duration
        if declared is None or not _DECLARING_FORMATS & self._format:
            return None
        return Fraction(declared, av.time_base)

    def end_pts(self) -> int:
        """After the last frame: its time plus its duration as far as the file knows it."""
        return self._video_end


def _starts_again(packet: Packet[VideoStream], before: Packet[VideoStream]) -> bool:
    return packet.dts is not None and before.dts is not None and packet.dts < before.dts


def iter_frames(path: Path) -> Iterator[tuple[int, int, float, NDArray[np.uint8]]]:
    """Every decodable frame as (index, pts, time_s, rgb): seconds from the first frame, (h, w, 3) uint8 as turned.

    The numbering is that of the frame table. Raises `BadInput` when the file is no video.
    """
    with VideoReader(path) as reader:
        first: int | None = None
        for frame in reader.frames():
            first = frame.pts if first is None else first
            yield frame.index, frame.pts, float((frame.pts - first) * reader.time_base), frame.rgb()
