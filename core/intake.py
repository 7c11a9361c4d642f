"""What can be known to be wrong within seconds, before anything is computed.

`python -m core.intake` does the same in a process of its own with limits, because a decoder that meets a
hostile file may take any memory or time, or crash: the question comes as JSON on stdin, the answer leaves
as JSON on stdout.
"""

from __future__ import annotations

import json
import math
import resource
import signal
import sys
from collections.abc import Sequence
from itertools import islice
from pathlib import Path
from typing import NotRequired, TypedDict

from core.annotations.foreign.unreadable import is_video_file
from core.annotations.load import load_annotations
from core.confinement import ProcessLimits, confine, die_with
from core.errors import BadInput, BladeAtlasError
from core.geometry.lens import scale_to
from core.roi import crop_of
from core.settings import Settings
from core.settings.groups import RoiSettings
from core.video.decode import DecodedFrame, VideoReader
from core.video.factory import open_video
from core.video.limits import PIXELS_ONLY, VideoLimits
from core.video.orientation import square_width
from core.video.picture_reader import PictureReader
from core.videos import Recording, RecordingFields, naming_video, require_count, require_one_size

_OPEN_FILES = 64


class LimitFields(TypedDict, total=False):
    """Fields of `VideoLimits` that are not its defaults."""

    max_frame_pixels: int
    max_video_frames: float
    max_video_seconds: float


class Question(TypedDict):
    """What `answer` is asked; paths as text."""

    recordings: list[RecordingFields]
    video_stream: NotRequired[int | None]
    fps: NotRequired[float | None]
    annotation_format: NotRequired[str]
    roi: dict[str, float]
    """Shares of the frame: x0, y0, x1, y1."""
    calibration_size: NotRequired[tuple[int, int] | None]
    """Width and height of the picture that a calibration is of, px."""
    limits: NotRequired[LimitFields]


class Answer(TypedDict, total=False):
    """What `answer` says: `error` alone, or the others."""

    videos: list[VideoSize]
    n_detections: int
    error: dict[str, object]
    """`BladeAtlasError.to_dict`."""


class VideoSize(TypedDict):
    """What `check_video` says of a video; sizes in px."""

    width: int
    height: int
    codec: str
    declared_frames: int
    declared_s: float
    """0 where the header does not say."""


def check_input(recordings: Sequence[Recording], settings: Settings) -> None:
    """Refuse input that no run can use; `BadInput` names what is wrong and where.

    The first two frames are decoded, the annotations are read in full. What only a full pass can find
    (damage further on, an interval outside the video) the stages say.
    """
    options = settings.input
    videos = _checked(recordings, options.video_stream, PIXELS_ONLY, options.fps)
    _read_annotations(recordings, videos, options.annotation_format)
    if settings.camera.size_px is not None:
        scale_to(settings.camera.size_px, videos[0]["width"], videos[0]["height"])
    check_roi(settings)


def _checked(
    recordings: Sequence[Recording], stream: int | None, limits: VideoLimits, fps: float | None
) -> list[VideoSize]:
    """Sizes of all videos, which are one; limits on frames and seconds hold for their sum."""
    require_count(len(recordings))
    videos: list[VideoSize] = []
    for number, one in enumerate(recordings):
        with naming_video(number, len(recordings)):
            try:
                videos.append(check_video(one.video, stream, limits, fps))
            except BadInput as error:
                raise in_what_order(error, one.annotations) from None
        require_one_size([(found["width"], found["height"]) for found in videos])
    if len(videos) > 1:
        _require_sum(videos, limits)
    return videos


def _require_sum(videos: Sequence[VideoSize], limits: VideoLimits) -> None:
    frames, seconds = sum(one["declared_frames"] for one in videos), sum(one["declared_s"] for one in videos)
    if frames > limits.max_video_frames:
        message = f"the videos have {frames} frames; at most {limits.max_video_frames} are taken (max_video_frames)"
        raise BadInput(message, code="too_many_frames", where="video")
    if seconds > limits.max_video_seconds:
        longest = f"at most {limits.max_video_seconds:g} s are taken (max_video_seconds)"
        raise BadInput(f"the videos last {seconds:.0f} s; {longest}", code="too_long", where="video")


def _read_annotations(recordings: Sequence[Recording], videos: Sequence[VideoSize], form: str) -> int:
    """Read all annotation files; how many detections they hold."""
    count = 0
    for number, (one, found) in enumerate(zip(recordings, videos, strict=True)):
        with naming_video(number, len(recordings)):
            count += len(load_annotations(one.annotations, (found["width"], found["height"]), form).detections)
    return count


def in_what_order(error: BadInput, annotations: Path | None) -> BadInput:
    """The error of a video that is none; when the annotations are one, that they are in the wrong order."""
    if error.code != "not_a_video" or annotations is None or not is_video_file(annotations):
        return error
    return BadInput(
        "the video and the annotations are in the wrong order: what should be the annotations is a video",
        code="swapped_files",
        where="video",
    )


def check_video(
    video: Path, stream: int | None = None, limits: VideoLimits = PIXELS_ONLY, fps: float | None = None
) -> VideoSize:
    """Size as shown and codec of a video; `BadInput` unless the file is one whose first frames decode.

    What the header states is held against `limits` before a frame is decoded: `too_many_pixels`,
    `too_many_frames`, `too_long`.

    Args:
        video: the file.
        stream: number of the video stream; None takes the film.
        limits: the largest video that is taken.
        fps: frames per second where the video holds no times.
    """
    with open_video(video, stream, fps=fps, max_pixels=limits.max_frame_pixels) as reader:
        _require_length(reader, limits)
        shapes = [_shown_size(reader, frame) for frame in islice(reader.frames(), 2)]
        codec, declared, seconds = reader.codec, reader.declared_frames, float(reader.declared_s or 0)
    if not shapes:
        raise BadInput(f"the video '{video.name}' holds no frame that decodes", code="no_frames", where="video")
    width, height = shapes[0]
    return {"width": width, "height": height, "codec": codec, "declared_frames": declared, "declared_s": seconds}


def _shown_size(reader: VideoReader | PictureReader, frame: DecodedFrame) -> tuple[int, int]:
    """Width and height of a frame with square pixels, turned; it is converted once, so that a failure shows here."""
    height, width, _ = frame.rgb().shape
    if reader.orientation.swap_axes:
        return width, square_width(height, reader.sample_aspect_ratio)
    return square_width(width, reader.sample_aspect_ratio), height


def _require_length(reader: VideoReader | PictureReader, limits: VideoLimits) -> None:
    frames, seconds = reader.declared_frames, reader.declared_s
    if frames > limits.max_video_frames:
        message = f"the video has {frames} frames; at most {limits.max_video_frames} are taken (max_video_frames)"
        raise BadInput(message, code="too_many_frames", where="video")
    if seconds is not None and seconds > limits.max_video_seconds:
        longest = f"at most {limits.max_video_seconds:g} s are taken (max_video_seconds)"
        raise BadInput(f"the video lasts {float(seconds):.0f} s; {longest}", code="too_long", where="video")


def check_roi(settings: Settings) -> None:
    """`BadInput` for a region of interest that holds nothing."""
    roi = settings.roi
    if not (roi.x0 < roi.x1 and roi.y0 < roi.y1):
        raise BadInput(
            f"the region of interest {roi.x0},{roi.y0},{roi.x1},{roi.y1} is empty", code="empty_roi", where="roi"
        )


def answer(question: Question) -> Answer:
    """Check what a question names.

    Args:
        question: ``recordings`` (paths) and ``roi`` (shares), optionally ``annotation_format``, ``video_stream``,
            ``fps``, ``calibration_size``, ``limits`` (`VideoLimits`).

    Returns:
        ``{"videos": [{...}], "n_detections": n}``, or ``{"error": BladeAtlasError.to_dict()}``.
    """
    try:
        recordings = [Recording.from_dict(one) for one in question["recordings"]]
        limits = VideoLimits(**question.get("limits", {}))
        videos = _checked(recordings, question.get("video_stream"), limits, question.get("fps"))
        size = question.get("calibration_size")
        if size is not None:
            scale_to(size, videos[0]["width"], videos[0]["height"])
        crop_of(RoiSettings(**question["roi"]), videos[0]["width"], videos[0]["height"])
        n_detections = _read_annotations(recordings, videos, question.get("annotation_format", "auto"))
    except BladeAtlasError as error:
        return {"error": error.to_dict()}
    except MemoryError:
        return {"error": BadInput("the input needs more memory than it may take", code="too_complex").to_dict()}
    except Exception as error:  # noqa: BLE001 - the border of the process: what a decoder stumbles over is bad input
        message = f"the input cannot be read ({type(error).__name__})"
        return {"error": BadInput(message, code="probe_died", where="video").to_dict()}
    return {"videos": videos, "n_detections": n_detections}


def limit_process(parent: int, memory_bytes: int, seconds: float) -> None:
    """Hold this process to its limits: address space, processor time, no file written, no life after `parent`."""
    confine(ProcessLimits(address_bytes=memory_bytes, cpu_s=max(1, math.ceil(seconds))))
    die_with(parent, signal.SIGKILL)
    for what, most in ((resource.RLIMIT_FSIZE, 0), (resource.RLIMIT_NOFILE, _OPEN_FILES)):
        resource.setrlimit(what, (most, most))


def main() -> None:
    """Answer one question."""
    question = json.load(sys.stdin)
    limit_process(int(question["parent"]), int(question["memory_bytes"]), float(question["seconds"]))
    json.dump(answer(question), sys.stdout)


if __name__ == "__main__":
    main()
