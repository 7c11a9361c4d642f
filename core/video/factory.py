"""Open whatever is a video: a file, or pictures."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

from core.errors import BadInput
from core.video.decode import VideoReader
from core.video.limits import MAX_FRAME_PIXELS
from core.video.picture_reader import PictureReader
from core.video.pictures import find_pictures
from core.video.table import VideoInfo


def open_video(
    path: Path,
    stream: int | None = None,
    *,
    fps: float | Fraction | None = None,
    max_pixels: int = MAX_FRAME_PIXELS,
) -> VideoReader | PictureReader:
    """Open a video for one pass of all its frames.

    Args:
        path: a file, a folder of pictures, a pattern of their names, or a zip of them.
        stream: number of the video stream of a file; None takes the film.
        fps: frames per second where the file holds no times.
        max_pixels: limit on the pixels of a picture.

    Raises:
        BadInput: as of `VideoReader`, `PictureReader` and `core.video.pictures.find_pictures`.
    """
    pictures = find_pictures(path)
    if pictures is None:
        return VideoReader(path, stream, fps=fps, max_pixels=max_pixels)
    if stream is not None:
        pictures.close()
        message = f"'{path.name}' consists of pictures and has no video stream {stream}"
        raise BadInput(message, code="no_such_stream", where="input.video_stream")
    return PictureReader(pictures, fps=fps, max_pixels=max_pixels)


def reopen_video(path: Path, info: VideoInfo, *, max_pixels: int = MAX_FRAME_PIXELS) -> VideoReader | PictureReader:
    """Open a video again that was probed before, in the same way."""
    fps = info.average_rate if info.times_from == "given" else None
    return open_video(path, info.stream, fps=fps, max_pixels=max_pixels)
