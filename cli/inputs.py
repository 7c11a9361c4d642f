"""`bladeatlas probe` and `check`: what a video is, and what was understood of an annotation file."""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

from cli.input_files import annotation_file, with_format
from cli.parameters import parse_assignment
from cli.progress import duration
from cli.terminal import say, say_json
from core.annotations.load import load_annotations
from core.annotations.model import Annotations
from core.annotations.placed import place
from core.annotations.summary import AnnotationSummary, summarise
from core.errors import BadInput
from core.intake import in_what_order
from core.settings import make_settings
from core.settings.reading import InputSettings
from core.video.probe import probe_video
from core.video.table import RATE_FROM, FrameTable, VideoInfo, colon_text, listed


def probe(parsed: argparse.Namespace) -> int:
    """Decode the whole video once and say what it holds; a damaged video is described, not refused."""
    fps = make_settings("default", {"input.fps": parsed.fps}).input.fps
    found = []
    for video in parsed.videos:
        table = probe_video(video, allow_truncated=True, stream=parsed.stream, fps=fps)
        found.append({**table.info.to_dict(), **_gaps(table)})
        if not parsed.json:
            _say_video(video.name, table)
    if parsed.json:
        say_json({"schema_version": 1, **(found[0] if len(found) == 1 else {"videos": found})}, indent=1)
    return 0


def _say_video(name: str, table: FrameTable) -> None:
    info, gaps = table.info, _gaps(table)
    steps = f"{gaps['min_step_s']:.4f} to {gaps['max_step_s']:.4f} s"
    say(
        f"{name}: {info.width}x{info.height}, {info.codec}, {info.n_frames} frames",
        f"  duration {duration(info.duration_s)}, {float(info.average_rate):.4g} frames/s on average",
        f"  time between frames {steps}, {'variable' if gaps['variable_rate'] else 'constant'} rate",
        *(f"  {note}" for note in notes(info)),
    )


def notes(info: VideoInfo) -> list[str]:
    """What somebody should know of a video before using it; empty for an ordinary sound one."""
    found = []
    if info.rotation_deg:
        found.append(f"rotated by {info.rotation_deg} degrees; size and boxes are of the frame as shown")
    if info.streams:
        streams = "; ".join(info.streams)
        found.append(f"stream {info.stream} was read of {streams} (--set input.video_stream=N for another)")
    if info.sample_aspect_ratio != 1:
        share = colon_text(info.sample_aspect_ratio)
        found.append(f"pixels are not square ({share}); frames are resampled, size and boxes are of square pixels")
    if info.interlaced_frames:
        frames = f"{info.interlaced_frames} of {info.n_frames} frames"
        found.append(f"interlaced: {frames}; they are deinterlaced, one picture per frame")
    if info.times_from != "file":
        rate = f"{float(info.average_rate):g} frames/s, {RATE_FROM[info.times_from]}"
        found.append(f"the file holds no times; they are made from {rate}")
    if info.joined:
        found.append(f"joined from {len(info.joined) + 1} recordings, at frame {', '.join(map(str, info.joined))}")
    if info.repaired_times:
        found.append(f"{info.repaired_times} frames have no usable time in the file; it is made from the frame rate")
    if info.damaged_pictures:
        found.append(f"damaged pictures: frame {listed(info.damaged_pictures)}; they give no keypoints")
    if info.truncated:
        found.append(f"damaged: {'; '.join(info.damage)} (a run needs --allow-truncated)")
    return found


def _gaps(table: FrameTable) -> dict[str, float | bool]:
    times = [row.time_s for row in table.rows]
    steps = [later - earlier for earlier, later in pairwise(times)]
    shortest, longest = min(steps), max(steps)
    return {"min_step_s": shortest, "max_step_s": longest, "variable_rate": longest > 1.5 * shortest}


def check(parsed: argparse.Namespace) -> int:
    """Read annotations, match them with the video's frames when one is given, and say what they hold."""
    options = input_options(with_format(parsed), parsed.fps)
    found = []
    for file, video in _pairs(parsed.files):
        annotations, table = read_with_video(file, video, options)
        info = None if table is None else table.info
        summary = summarise(annotations, None if table is None else place(annotations, table, options.time_convention))
        found.append({**summary.to_dict(), "video": None if info is None else info.to_dict()})
        if not parsed.json:
            _say_annotations(file.name, summary, info)
    if parsed.json:
        say_json({"schema_version": 1, **(found[0] if len(found) == 1 else {"annotations": found})}, indent=1)
    return 0


def _pairs(files: Sequence[Path]) -> list[tuple[Path, Path | None]]:
    """Annotation files with the video that each is of; `BadInput` when the last of several has none."""
    if len(files) == 1:
        return [(files[0], None)]
    if len(files) % 2:
        message = f"{len(files)} files are no pairs of annotations and video: write ANNOTATIONS VIDEO for each"
        raise BadInput(message, code="annotations_count", where="ANNOTATIONS")
    return list(zip(files[::2], files[1::2], strict=True))


def _say_annotations(name: str, summary: AnnotationSummary, video: VideoInfo | None) -> None:
    times = f"{summary.n_keys_with_detections} of {summary.n_keys} times"
    say(f"{name}: {summary.n_detections} detections at {times}", *lines(summary))
    say(*(f"  video: {note}" for note in (() if video is None else notes(video))))


def input_options(assignments: list[str], fps: float | None = None) -> InputSettings:
    """Options of the input as ``NAME=VALUE``; others are refused, because nothing here would read them."""
    options: dict[str, Any] = {} if fps is None else {"input.fps": fps}
    options |= (parse_assignment(one) for one in assignments)
    for name in options:
        if not name.startswith("input."):
            raise BadInput(f"'{name}' says nothing about the input; check takes only input.* options", where="--set")
    return make_settings("default", options).input


def read_with_video(path: Path, video: Path | None, options: InputSettings) -> tuple[Annotations, FrameTable | None]:
    """Annotations, held against the frames of the video when one is given."""
    table = None
    if video is not None:
        try:
            table = probe_video(video, allow_truncated=True, stream=options.video_stream, fps=options.fps)
        except BadInput as error:
            raise in_what_order(error, path) from None
    frame = None if table is None else (table.info.width, table.info.height)
    with annotation_file(path) as file:
        return load_annotations(file, frame, options.annotation_format), table


def lines(summary: AnnotationSummary) -> list[str]:
    """The summary in a few lines."""
    found = [
        f"  format: {summary.format}",
        f"  labels: {_counts(summary.detections_by_label)}",
        f"  masks: {_counts(summary.masks_by_label)}",
        f"  detections with an outline: {summary.n_with_polygon}, with a track: {summary.n_with_track}",
    ]
    if summary.first_time_s is not None:
        found.append(f"  times: {summary.first_time_s:.4f} to {summary.last_time_s:.4f} s")
    if summary.n_annotated_frames is not None:
        found.append(
            f"  in the video: {summary.n_annotated_frames} frames with detections, "
            f"{summary.n_keys_outside_video} times outside"
        )
    if summary.time_convention is not None:
        found += _times(summary.time_convention)
    found.append(f"  read as: {summary.convention}")
    found += [f"  warning: {warning}" for warning in summary.warnings]
    if summary.n_warnings > len(summary.warnings):
        found.append(f"  and {summary.n_warnings - len(summary.warnings)} further warnings")
    return found


def _times(read: dict[str, Any]) -> list[str]:
    """How the time keys were read."""
    told = ", as told" if read["forced"] else ""
    lines = [
        f"  time keys: {read['clock']}{told}, rounding {read['rounding']}, at most {read['max_miss_s']:.6f} s off; "
        f"{read['frames_hit']} frames hit, {read['strays']} keys miss every frame",
    ]
    if read["first"]:
        ends = [
            f"{name} {json.dumps(hit['key'])} = frame {hit['source_index']} at {hit['time_s']:.4f} s"
            for name, hit in (("first", read["first"]), ("last", read["last"]))
        ]
        lines.append(f"  keys: {', '.join(ends)}")
    lines.append(f"  other readings that fit: {', '.join(read['rivals']) or 'none'}")
    return lines


def _counts(counts: dict[str, int]) -> str:
    return ", ".join(f"{label} {count}" for label, count in counts.items()) or "none"
