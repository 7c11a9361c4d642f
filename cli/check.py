"""`bladeatlas check`: what was understood of an annotation file."""

from __future__ import annotations

import argparse
import json

from core.annotations.parse import load_annotations
from core.annotations.placed import place
from core.annotations.summary import AnnotationSummary, summarise
from core.video.probe import probe_video


def command(parsed: argparse.Namespace) -> int:
    """Read annotations, match them with the video's frames when one is given, and say what they hold."""
    annotations = load_annotations(parsed.annotations)
    placed = place(annotations, probe_video(parsed.video, allow_truncated=True)) if parsed.video else None
    summary = summarise(annotations, placed)
    if parsed.json:
        print(json.dumps({"schema_version": 1, **summary.to_dict()}, indent=1, allow_nan=False))
    else:
        print(f"{parsed.annotations.name}: {text(summary)}")
    return 0


def text(summary: AnnotationSummary) -> str:
    """The summary in a few lines."""
    lines = [
        f"{summary.n_detections} detections at {summary.n_keys_with_detections} of {summary.n_keys} times",
        f"  labels: {_counts(summary.detections_by_label)}",
        f"  masks: {_counts(summary.masks_by_label)}",
        f"  detections with an outline: {summary.n_with_polygon}, with a track: {summary.n_with_track}",
    ]
    if summary.first_time_s is not None:
        lines.append(f"  times: {summary.first_time_s:.4f} to {summary.last_time_s:.4f} s")
    if summary.n_annotated_frames is not None:
        lines.append(
            f"  in the video: {summary.n_annotated_frames} frames with detections, "
            f"{summary.n_keys_outside_video} times outside"
        )
    lines.append(f"  read as: {summary.convention}")
    lines += [f"  warning: {warning}" for warning in summary.warnings]
    if summary.n_warnings > len(summary.warnings):
        lines.append(f"  and {summary.n_warnings - len(summary.warnings)} further warnings")
    return "\n".join(lines)


def _counts(counts: dict[str, int]) -> str:
    return ", ".join(f"{label} {count}" for label, count in counts.items()) or "none"
