"""Open a video file: which formats, which of its streams is the film, how large its pictures may be."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import cast

import av
from av.container import InputContainer
from av.stream import Disposition

from core.errors import BadInput
from core.files import require_file
from core.video.formats import FORMAT_WHITELIST, READABLE

_PICTURE = Disposition.attached_pic | Disposition.timed_thumbnails | Disposition.still_image | Disposition.dependent
"""Streams that are no film of their own: covers, thumbnails, still images, layers of another stream."""
_PREVIEW_SHARE = Fraction(1, 4)
"""A stream with less than this share of the pixels of the largest one is a preview, whatever it is marked as."""

_CLOCK = re.compile(r"(\d{1,6}):(\d\d):(\d\d(?:\.\d{1,12})?)")


@dataclass(frozen=True)
class VideoStream:
    """One video stream of a file as its header describes it."""

    index: int
    """FFmpeg's number among all streams of the file, audio and data included."""
    codec: str
    width: int
    height: int
    frames: int
    """As declared, or estimated from the duration; 0 when unknown."""
    default: bool
    picture: bool
    """Marked as a cover, a thumbnail or a part of another stream."""

    def __str__(self) -> str:
        frames = f", {self.frames} frame{'s' if self.frames > 1 else ''}" if self.frames else ""
        return f"stream {self.index} ({self.codec}, {self.width}x{self.height}{frames})"


def open_container(path: Path) -> InputContainer:
    """Open a file with FFmpeg, as a file whatever its name looks like.

    Raises:
        BadInput: `not_a_video`, or a file error of `core.files.require_file`.
    """
    require_file(path, "video")
    try:
        return av.open(
            # Without the protocol's name, one in the file's name would be taken for it: "axis:2.mp4".
            f"file:{os.path.abspath(path)}",
            options={"format_whitelist": FORMAT_WHITELIST, "protocol_whitelist": "file"},
            metadata_errors="replace",
        )
    except (av.error.FFmpegError, ValueError):
        raise BadInput(
            f"'{path.name}' is not a video that can be read (unknown format, or its index is missing); "
            f"readable are {READABLE}",
            code="not_a_video",
            where="video",
        ) from None


def film_of(
    container: InputContainer, name: str, wanted: int | None = None
) -> tuple[av.VideoStream, tuple[VideoStream, ...]]:
    """The stream that holds the film, and all video streams of the file.

    Args:
        container: as opened.
        name: of the file, for messages.
        wanted: number of the stream that the user asks for; None lets `choose_film` decide.

    Raises:
        BadInput: `audio_only`, `not_a_video`, `unknown_codec`, `no_such_stream`.
    """
    usable = {s.index: s for s in container.streams.video if s.codec_context is not None and s.time_base}
    known = tuple(_described(container, stream) for stream in usable.values())
    if wanted is not None:
        if wanted not in usable:
            there = ", ".join(map(str, known)) or "none"
            message = f"'{name}' has no video stream {wanted}; its video streams: {there}"
            raise BadInput(message, code="no_such_stream", where="input.video_stream")
        return usable[wanted], known
    film = choose_film(known)
    if film is not None:
        return usable[film.index], known
    if any(not s.disposition & Disposition.attached_pic for s in container.streams.video):
        raise BadInput(f"'{name}' uses a video codec that is not known", code="unknown_codec", where="video")
    if container.streams.audio:
        raise BadInput(f"'{name}' holds only audio, no video", code="audio_only", where="video")
    raise BadInput(f"'{name}' holds no video", code="not_a_video", where="video")


def time_base_of(stream: av.VideoStream) -> Fraction:
    """Seconds per unit of a stream's times; `film_of` takes no stream without one."""
    return Fraction(cast(Fraction, stream.time_base))


def choose_film(streams: Sequence[VideoStream]) -> VideoStream | None:
    """The film among the video streams of a file: never a picture or a preview.

    Of the streams whose pixels in all frames come near the largest's, it is the one that is marked as default;
    where that leaves several, the one with most pixels; the first of equals. None when there is none.
    """
    films = [one for one in streams if not one.picture]
    # Covers are not always marked as such; a stream of one frame is a film only where there is nothing else.
    films = [one for one in films if one.frames != 1] or films
    if not films:
        return None
    sizes = _sizes(films)
    large = [one for one in films if sizes[one.index] >= _PREVIEW_SHARE * max(sizes.values())]
    marked = [one for one in large if one.default] or large
    return max(marked, key=lambda one: (sizes[one.index], -one.index))


def _sizes(films: Sequence[VideoStream]) -> dict[int, int]:
    """Pixels of each stream, by number: of all its frames, or of one where a number of frames is unknown."""
    counted = all(one.frames for one in films)
    return {one.index: one.width * one.height * (one.frames if counted else 1) for one in films}


def _described(container: InputContainer, stream: av.VideoStream) -> VideoStream:
    codec = stream.codec_context
    return VideoStream(
        index=int(stream.index),
        codec=str(codec.name),
        width=int(codec.width),
        height=int(codec.height),
        frames=_declared_frames(container, stream),
        default=bool(stream.disposition & Disposition.default),
        picture=bool(stream.disposition & _PICTURE),
    )


def _declared_frames(container: InputContainer, stream: av.VideoStream) -> int:
    if stream.frames:
        return int(stream.frames)
    # Matroska writers count and time each stream only in tags.
    tags = {str(name).split("-")[0]: str(value) for name, value in stream.metadata.items()}
    if tags.get("NUMBER_OF_FRAMES", "").isdigit():
        return int(tags["NUMBER_OF_FRAMES"])
    clock = _CLOCK.fullmatch(tags.get("DURATION", ""))
    if clock:
        seconds = int(clock[1]) * 3600 + int(clock[2]) * 60 + Fraction(clock[3])
    elif stream.duration is not None:
        seconds = stream.duration * time_base_of(stream)
    elif container.duration is not None:
        seconds = Fraction(container.duration, av.time_base)
    else:
        return 0
    return round(seconds * Fraction(stream.average_rate)) if stream.average_rate else 0


def require_pixels(width: int, height: int, name: str, limit: int) -> None:
    """Refuse pictures that are too large to be worked on; `BadInput` `too_many_pixels` names the limit."""
    if width * height > limit:
        raise BadInput(
            f"the pictures of '{name}' have {width}x{height} = {width * height:,} pixels; at most {limit:,} are read",
            code="too_many_pixels",
            where="video",
        )
