"""A video that is made of pictures, read as `core.video.decode.VideoReader` reads a file."""

from __future__ import annotations

import re
from collections.abc import Iterator
from fractions import Fraction
from types import TracebackType
from typing import Any, cast

import av

from core.errors import BadInput
from core.video.complaints import Complaints, listened
from core.video.container import VideoStream, require_pixels
from core.video.decode import DecodedFrame
from core.video.formats import PICTURE_CODECS
from core.video.limits import MAX_FRAME_PIXELS
from core.video.orientation import Orientation
from core.video.pictures import PictureFiles
from core.video.soundness import Loss
from core.video.table import TimesFrom

_TOO_LARGE = re.compile(r"Picture size (\d+)x(\d+) exceeds")
"""What FFmpeg says of a picture whose header states more pixels than its decoder may make."""


class PictureReader:
    """Pictures opened for one pass. Attributes are those of `VideoReader`; every picture is a keyframe.

    Marks in the pictures that ask for a turn (EXIF) and shares of pixels are ignored: recorders that write single
    pictures write such marks from a sensor of the probe, if at all, and other tools count boxes without them.

    Args:
        pictures: the files; closed by this reader.
        fps: frames per second, which pictures do not tell; `BadInput` `fps_missing` without.
        max_pixels: pictures with more are refused, from their header.
    """

    def __init__(
        self, pictures: PictureFiles, *, fps: float | Fraction | None = None, max_pixels: int = MAX_FRAME_PIXELS
    ) -> None:
        self.name = pictures.source.name
        self._pictures = pictures
        self._max_pixels = max_pixels
        if fps is None:
            pictures.close()
            raise BadInput(
                f"the pictures of '{self.name}' hold no times: say how many there are per second (--fps N, input.fps)",
                code="fps_missing",
                where="input.fps",
            )
        self.declared_rate: Fraction | None = Fraction(str(fps))
        self.time_base = 1 / self.declared_rate
        self.times_from: TimesFrom = "given"
        self.declared_frames = len(pictures.names)
        self.declared_s: Fraction | None = self.declared_frames * self.time_base
        self.codec = _codec_of(pictures.names[0])
        self.stream_index: int | None = None
        self.streams: tuple[VideoStream, ...] = ()
        self.sample_aspect_ratio = Fraction(1)
        self.interlaced_frames = 0
        self.field_order = ""
        self.orientation = Orientation()
        self.repaired_times = 0
        self.joined: list[int] = []
        self.losses: list[Loss] = []
        self.faults: list[str] = []
        self._complaints = Complaints()

    def __enter__(self) -> PictureReader:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._pictures.close()

    @property
    def damaged(self) -> tuple[int, ...]:
        """After the last frame: those of the frames whose decoder complained of their picture."""
        return self._complaints.frames()

    def frames(self) -> Iterator[DecodedFrame]:
        """Frames in order; a picture that does not decode is left out and noted in `faults`.

        Raises:
            BadInput: `frame_size_changes` names the first picture of another size; `too_many_pixels`.
        """
        shape: tuple[int, int] | None = None
        index = 0
        for number, name in enumerate(self._pictures.names):
            frame = self._decoded(name, number)
            if frame is None:
                self.faults.append(f"the picture '{name}' does not decode")
                continue
            if shape is None:
                shape = (frame.width, frame.height)
            elif shape != (frame.width, frame.height):
                raise BadInput(
                    f"the picture '{name}' of '{self.name}' is {frame.width}x{frame.height}, "
                    f"those before it are {shape[0]}x{shape[1]}",
                    code="frame_size_changes",
                    where="video",
                )
            self._complaints.came(index, number)
            yield DecodedFrame(index, number, True, frame, self.orientation)
            index += 1

    def missing_at_end_s(self, spacing_s: Fraction) -> Fraction:
        """Seconds that are promised and not there: none."""
        return Fraction(0)

    def end_pts(self) -> int:
        """After the last frame: when it ends."""
        return self.declared_frames

    def _decoded(self, name: str, number: int) -> Any:
        """FFmpeg's frame of a picture; None when there is none."""
        data = self._pictures.read(name)
        # A decoder of its own for each: some take a further picture for changes of the one before.
        decoder = cast("av.VideoCodecContext", av.CodecContext.create(_codec_of(name), "r"))
        decoder.thread_type = "NONE"
        decoder.options = {"max_pixels": str(self._max_pixels)}
        with listened() as said:
            try:
                frames = decoder.decode(av.Packet(data)) or decoder.decode(None)
            except (av.error.FFmpegError, ValueError):
                frames = []
        for _, _, text in said:
            large = _TOO_LARGE.match(text)
            if large:
                require_pixels(int(large[1]), int(large[2]), name, self._max_pixels)
        self._complaints.heard(number, said)
        return frames[0] if frames else None


def _codec_of(name: str) -> str:
    return PICTURE_CODECS[name.rpartition(".")[2].lower()]
