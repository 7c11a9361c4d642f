"""Decode a video once and know everything that later stages ask of it."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Sequence
from fractions import Fraction
from pathlib import Path

from core.errors import BadInput
from core.video.clock import FALLBACK_RATE
from core.video.decode import VideoReader
from core.video.factory import open_video
from core.video.limits import MAX_FRAME_PIXELS
from core.video.orientation import square_width
from core.video.picture_reader import PictureReader
from core.video.pictures import digest_of_video
from core.video.soundness import Loss
from core.video.table import FrameTable, ListedFrame, VideoInfo

_END_TOLERANCE_S = Fraction(1, 2)
"""Headers round, and audio ends a little apart from video; less than this at the end is no damage."""
_END_TOLERANCE_FRAMES = 3
_RATE_TOLERANCE = Fraction(1, 100)
_MAX_PLACES = 20
"""Places of damage that are named one by one."""

OnFrame = Callable[[int, int], None]
"""Called with (frames done, frames declared or 0)."""


def probe_video(
    path: Path,
    *,
    allow_truncated: bool = False,
    stream: int | None = None,
    fps: float | None = None,
    max_pixels: int = MAX_FRAME_PIXELS,
    on_frame: OnFrame | None = None,
) -> FrameTable:
    """Decode all frames in one pass of constant memory and return the frame table.

    Args:
        path: the video: a file, or pictures (`core.video.factory.open_video`).
        allow_truncated: take the decodable part of a damaged video instead of refusing it.
        stream: number of the video stream; None takes the film.
        fps: frames per second where the file holds no times.
        max_pixels: limit on the pixels of a picture.
        on_frame: progress; may raise to stop.

    Raises:
        BadInput: `not_a_video`, `audio_only`, `unknown_codec`, `no_frames`, `single_frame`,
            `truncated_video`, `frame_size_changes`, `unsupported_rotation`, `too_many_pixels`, `no_such_stream`,
            `fps_missing`, `fps_not_needed`, an error of `core.video.pictures.find_pictures`, or a file error of
            `core.files.require_file`. Each message names cause and file.
    """
    rows: list[ListedFrame] = []
    shape = (0, 0)
    with open_video(path, stream, fps=fps, max_pixels=max_pixels) as reader:
        for frame in reader.frames():
            rgb = frame.rgb()
            shape = (frame.coded.width, frame.coded.height)
            first = rows[0].pts if rows else frame.pts
            time_s = float((frame.pts - first) * reader.time_base)
            digest = hashlib.sha256(rgb.data).hexdigest()
            rows.append(ListedFrame(frame.index, frame.pts, time_s, frame.keyframe, digest))
            if on_frame:
                on_frame(len(rows), reader.declared_frames)
        damage = _damage(reader, rows)
        if damage and not allow_truncated:
            raise BadInput(
                f"the video '{path.name}' is truncated or damaged: {'; '.join(damage)}; "
                f"{len(rows)} frames decode (--allow-truncated uses them)",
                code="truncated_video",
                where="video",
            )
        _require_frames(path, len(rows))
        rate = _average_rate(reader, rows)
        seconds_known = (reader.end_pts() - rows[0].pts) * reader.time_base
        seconds_at_rate = (rows[-1].pts - rows[0].pts) * reader.time_base + 1 / rate
        width, height = square_width(shape[0], reader.sample_aspect_ratio), shape[1]
        info = VideoInfo(
            width=height if reader.orientation.swap_axes else width,
            height=width if reader.orientation.swap_axes else height,
            rotation_deg=reader.orientation.rotation_deg,
            mirrored=reader.orientation.mirrored,
            average_rate=rate,
            time_base=reader.time_base,
            duration_s=max(float(seconds_known), float(seconds_at_rate)),
            n_frames=len(rows),
            codec=reader.codec,
            sha256=digest_of_video(path),
            truncated=bool(damage),
            damage=tuple(damage),
            repaired_times=reader.repaired_times,
            joined=tuple(reader.joined),
            stream=reader.stream_index,
            streams=tuple(map(str, reader.streams)) if len(reader.streams) > 1 else (),
            declared_rate=reader.declared_rate,
            times_from=reader.times_from,
            sample_aspect_ratio=reader.sample_aspect_ratio,
            interlaced_frames=reader.interlaced_frames,
            field_order=reader.field_order,
            damaged_pictures=reader.damaged,
        )
    return FrameTable(info, tuple(rows))


def _require_frames(path: Path, n_frames: int) -> None:
    if n_frames == 0:
        raise BadInput(f"the video '{path.name}' holds no frame that decodes", code="no_frames", where="video")
    if n_frames == 1:
        raise BadInput(
            f"the video '{path.name}' holds only one frame; nothing can be measured from one view",
            code="single_frame",
            where="video",
        )


def _damage(reader: VideoReader | PictureReader, rows: Sequence[ListedFrame]) -> list[str]:
    """What is wrong with the file, in words and with its place; empty for a sound one."""
    damage = [*reader.faults, *(_lost(loss, rows) for loss in reader.losses[:_MAX_PLACES])]
    further = reader.losses[_MAX_PLACES:]
    if further:
        damage.append(f"{sum(loss.frames for loss in further)} frames lost at {len(further)} further places")
    # Not every header states a rate, and those that do may be wrong.
    rate = _average_rate(reader, rows) if len(rows) > 1 else reader.declared_rate or FALLBACK_RATE
    missing = reader.missing_at_end_s(1 / rate)
    if rows and missing > max(_END_TOLERANCE_S, _END_TOLERANCE_FRAMES / rate):
        damage.append(f"{float(missing):.1f} s missing at the end")
    return damage


def _lost(loss: Loss, rows: Sequence[ListedFrame]) -> str:
    last = loss.after - 1
    frames = "1 frame" if loss.frames == 1 else f"{loss.frames} frames"
    place = f"after frame {last} at {rows[last].time_s:.3f} s" if last >= 0 else "before the first frame"
    return f"{frames} lost {place} ({', '.join(loss.causes)})"


def _average_rate(reader: VideoReader | PictureReader, rows: Sequence[ListedFrame]) -> Fraction:
    """Frames per second: the container's figure where the frames bear it out, else that of the frames.

    Containers round their times, so their own figure is the better one for a constant rate; for a cut or
    repaired file it can be far off.
    """
    lost = sum(loss.frames for loss in reader.losses)
    measured = Fraction(len(rows) - 1 + lost) / ((rows[-1].pts - rows[0].pts) * reader.time_base)
    declared = reader.declared_rate
    if declared and abs(declared - measured) <= _RATE_TOLERANCE * measured:
        return declared
    return measured.limit_denominator(1_000_000)
