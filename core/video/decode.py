"""The only place that decodes video. Every frame number of this project counts what comes out here.

Frames come in presentation order, turned as the rotation flag asks, as RGB24. The decoder runs on one
thread: only then does it report every concealed error, and the result is the same on every machine.
After damage, frames are dropped up to the next keyframe, because they may refer to what is broken.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path
from types import TracebackType
from typing import Any

import av
import numpy as np
from av.sidedata.sidedata import Type as SideDataType
from av.stream import Disposition
from av.video.frame import PictureType
from numpy.typing import NDArray

from core.errors import BadInput
from core.files import require_file
from core.video.limits import MAX_FRAME_PIXELS
from core.video.orientation import Orientation

_FORMATS = (
    "mov,mp4,m4a,3gp,3g2,mj2,matroska,webm,avi,mpegts,mpeg,flv,asf,ogg,mxf,ivf,h264,hevc,m4v,mjpeg,mpegvideo,"
    "wav,mp3,aac,flac"
)
"""Containers that are opened. Playlists are not among them: they would make the decoder read other files.
Audio formats are, so that they can be named."""

_DECLARING_FORMATS = frozenset({"mov", "matroska", "avi", "flv", "asf"})
"""Containers whose header states a duration; elsewhere it is estimated and says nothing about damage."""


@dataclass(frozen=True)
class DecodedFrame:
    """One frame as decoded; `rgb` converts it."""

    index: int
    """Counts decoded frames from 0."""
    pts: int
    """Presentation time in units of the reader's time base, strictly increasing."""
    keyframe: bool
    _frame: Any = field(repr=False)
    _orientation: Orientation = field(repr=False)

    def rgb(self) -> NDArray[np.uint8]:
        """(h, w, 3) uint8 RGB, as shown."""
        return self._orientation.apply(self._frame.to_ndarray(format="rgb24"))


class VideoReader:
    """A video opened for one pass. Use as a context manager; iterate `frames()` once.

    Attributes:
        time_base: seconds per unit of `pts`.
        declared_rate: frames per second as the container states them; None when it does not.
        declared_frames: 0 when unknown.
        declared_s: length as the header states it; None where it states none.
        codec: name of the codec.
        damage: what was found broken so far, empty while nothing was.
        repaired_times: frames whose time was missing or not after the one before.
        orientation: known after the first frame.
    """

    def __init__(self, path: Path, *, max_pixels: int = MAX_FRAME_PIXELS) -> None:
        require_file(path, "video")
        self.name = path.name
        try:
            self._container = av.open(
                str(path),
                options={"format_whitelist": _FORMATS, "protocol_whitelist": "file"},
                metadata_errors="replace",
            )
        except (av.error.FFmpegError, ValueError):
            raise BadInput(
                f"'{path.name}' is not a video that can be read (unknown format, or its index is missing)",
                code="not_a_video",
                where="video",
            ) from None
        try:
            self._stream = self._video_stream()
            self._require_pixels(max_pixels)
        except BadInput:
            self._container.close()
            raise
        self._stream.thread_type = "NONE"
        self.time_base = Fraction(self._stream.time_base)
        rate = self._stream.average_rate
        self.declared_rate = Fraction(rate) if rate else None
        self.declared_frames = int(self._stream.frames)
        self.declared_s = self._declared_s()
        self.codec = str(self._stream.codec_context.name)
        self.damage: list[str] = []
        self.repaired_times = 0
        self.orientation = Orientation()
        self._first_s: Fraction | None = None
        self._end_s = Fraction(0)
        self._video_end = 0

    def __enter__(self) -> VideoReader:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._container.close()

    def _video_stream(self) -> Any:
        streams = [s for s in self._container.streams.video if not s.disposition & Disposition.attached_pic]
        usable = [s for s in streams if s.codec_context is not None and s.time_base]
        if usable:
            return usable[0]
        if streams:
            raise BadInput(f"'{self.name}' uses a video codec that is not known", code="unknown_codec", where="video")
        if self._container.streams.audio:
            raise BadInput(f"'{self.name}' holds only audio, no video", code="audio_only", where="video")
        raise BadInput(f"'{self.name}' holds no video", code="not_a_video", where="video")

    def _require_pixels(self, max_pixels: int) -> None:
        decoder = self._stream.codec_context
        if decoder.width * decoder.height > max_pixels:
            message = f"the pictures of '{self.name}' are {decoder.width}x{decoder.height}, more than the {max_pixels} "
            raise BadInput(f"{message}pixels that are taken", code="too_many_pixels", where="video")

    def frames(self) -> Iterator[DecodedFrame]:
        """Frames in presentation order; damage is noted in `damage` and its frames are left out."""
        previous, shape = None, None
        for index, frame in enumerate(self._sound()):
            if shape is None:
                shape = (frame.width, frame.height)
                self.orientation = self._read_orientation(frame)
            elif shape != (frame.width, frame.height):
                raise BadInput(
                    f"the frame size of '{self.name}' changes at frame {index}",
                    code="frame_size_changes",
                    where="video",
                )
            previous = self._time_of(frame, previous)
            self._video_end = previous + int(frame.duration or 0)
            yield DecodedFrame(index, previous, bool(frame.key_frame), frame, self.orientation)

    def _sound(self) -> Iterator[Any]:
        """Frames that depend on nothing broken.

        After damage they begin again at a keyframe. Frames predicted from both sides come out before the
        later one of the two, so they are held (a handful at most) until that one proves sound.
        """
        held: list[Any] = []
        started = waiting = False
        for frame in self._decode():
            if frame is None:
                yield from held
            if frame is None or frame.is_corrupt:
                # Recordings may begin in the middle of a group; what cannot decode there was never lost.
                self._note("frames that do not decode" if started else "")
                held, waiting = [], True
            elif waiting and not frame.key_frame:
                continue
            elif frame.pict_type == PictureType.B:
                held.append(frame)
            else:
                yield from held
                yield frame
                held, started, waiting = [], True, False
        yield from held

    def _decode(self) -> Iterator[Any]:
        """Frames of the video stream as PyAV gives them; None in place of a packet that does not decode.

        Before the None comes everything that was decoded before that packet.
        """
        decoder = self._stream.codec_context
        for packet in self._packets():
            if packet.is_corrupt:
                self._note("a packet that is cut off")
            else:
                try:
                    frames = packet.decode()
                except av.error.FFmpegError:
                    pass
                else:
                    yield from frames
                    continue
            yield from self._drained()
            decoder.flush_buffers()
            yield None

    def _drained(self) -> list[Any]:
        """What the decoder still holds."""
        try:
            return list(self._stream.codec_context.decode(None))
        except av.error.FFmpegError:
            return []

    def _packets(self) -> Iterator[Any]:
        """Packets of the video stream; those of all streams count towards how far the file reaches."""
        packets = self._container.demux()
        while True:
            try:
                packet = next(packets)
            except StopIteration:
                return
            except av.error.FFmpegError:
                self._note("data missing before the end")
                yield self._end()
                return
            if packet.pts is not None and packet.time_base:
                start = packet.pts * Fraction(packet.time_base)
                self._first_s = start if self._first_s is None else min(self._first_s, start)
                self._end_s = max(self._end_s, start + (packet.duration or 0) * Fraction(packet.time_base))
            if packet.stream_index == self._stream.index:
                yield packet

    def _end(self) -> Any:
        """The empty packet that makes the decoder hand out what it still holds."""
        packet = av.Packet()
        packet.stream = self._stream
        return packet

    def _note(self, what: str) -> None:
        if what and what not in self.damage:
            self.damage.append(what)

    def _read_orientation(self, frame: Any) -> Orientation:
        matrix = frame.side_data.get(SideDataType.DISPLAYMATRIX)
        return Orientation.from_display_matrix(bytes(matrix)) if matrix is not None else Orientation()

    def _time_of(self, frame: Any, previous: int | None) -> int:
        """PTS of a frame; one that is missing or not after `previous` is replaced by the next possible time."""
        if frame.pts is not None and (previous is None or frame.pts > previous):
            return int(frame.pts)
        self.repaired_times += 1
        if previous is None:
            return 0
        if frame.pts is not None:
            return previous + 1
        rate = self.declared_rate or Fraction(25)
        return previous + max(1, round(1 / (rate * self.time_base)))

    def missing_at_end_s(self) -> Fraction:
        """After the last frame: seconds that the header promises and the file does not hold; 0 when unknown."""
        if self.declared_s is None:
            return Fraction(0)
        return max(Fraction(0), self.declared_s - (self._end_s - (self._first_s or Fraction(0))))

    def _declared_s(self) -> Fraction | None:
        declared = self._container.duration
        if declared is None or not _DECLARING_FORMATS & set(self._container.format.name.split(",")):
            return None
        return Fraction(declared, av.time_base)

    def end_pts(self) -> int:
        """After the last frame: its time plus its duration as far as the file knows it."""
        return self._video_end


def iter_frames(path: Path) -> Iterator[tuple[int, int, float, NDArray[np.uint8]]]:
    """Every decodable frame as (index, pts, time_s, rgb): seconds from the first frame, (h, w, 3) uint8 as shown.

    The numbering is that of the frame table. Raises `BadInput` when the file is no video.
    """
    with VideoReader(path) as reader:
        first: int | None = None
        for frame in reader.frames():
            first = frame.pts if first is None else first
            yield frame.index, frame.pts, float((frame.pts - first) * reader.time_base), frame.rgb()
