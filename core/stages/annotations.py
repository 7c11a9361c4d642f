"""Stage `annotations`: the annotation file checked, typed and put on frames."""

from __future__ import annotations

from core.annotations.load import load_annotations
from core.annotations.placed import place
from core.annotations.summary import summarise
from core.io.annotations import write_annotations
from core.stage import StageResult, StageTask
from core.video.table import FrameTable


def run(task: StageTask) -> StageResult:
    """Write `detections.json`, `masks.json` and `looked_at.json`; `BadInput` when the file cannot be used.

    Without an annotation file all are empty.
    """
    table, wanted = FrameTable.read(task.input("probe")), task.settings.input
    annotations = load_annotations(task.annotations, (table.info.width, table.info.height), wanted.annotation_format)
    task.report(1, 2, f"{len(annotations.entries)} time keys")
    placed = place(annotations, table, wanted.time_convention)
    write_annotations(task.out, placed.detections, placed.masks, placed.looked_at)
    summary = summarise(annotations, placed)
    return StageResult(
        {
            "format": summary.format,
            "n_detections": summary.n_detections,
            "n_keys": summary.n_keys,
            "n_annotated_frames": summary.n_annotated_frames,
            "n_without_frame": sum(d.source_index is None for d in placed.detections),
            "labels": summary.detections_by_label,
            "warnings": list(summary.warnings),
            "time_convention": placed.convention.to_dict(),
            "flags": [flag.to_dict() for flag in placed.flags],
        }
    )
