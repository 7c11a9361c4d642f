"""`bladeatlas check`: what was understood of an annotation file."""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from cli.input_files import annotation_file, with_format
from cli.parameters import parse_assignment
from cli.probe import notes
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
from core.video.table import FrameTable, VideoInfo


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
