"""Stage `annotations`: the annotation file of every video checked, typed and put on its frames."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

from core.annotations.load import load_annotations
from core.annotations.model import Annotations
from core.annotations.placed import PlacedAnnotations, place
from core.annotations.summary import summarise
from core.io.annotations import write_annotations
from core.products.front import AnnotationsProduct
from core.stage import StageTask
from core.video.table import FrameTable, read_tables
from core.videos import named, naming_video


def run(task: StageTask) -> AnnotationsProduct:
    """Write `detections.json`, and `masks.json` and `looked_at.json` of every video.

    A video without an annotation file has none of them. Each file's keys are read on the clock of its own video.

    Raises:
        BadInput: a file cannot be used.
    """
    tables, total = read_tables(task.input("probe")), len(task.recordings)
    files: list[tuple[Annotations, PlacedAnnotations]] = []
    for video, table in enumerate(tables):
        with naming_video(video, total):
            annotations = _read(task, video, table)
            n_before = sum(len(placed.detections) for _, placed in files)
            files.append((annotations, place(annotations, table, task.settings.input.time_convention, video, n_before)))
        task.report(video + 1, total, named(f"{len(annotations.entries)} time keys", video, total))
    placed = [one for _, one in files]
    write_annotations(
        task.out,
        [detection for one in placed for detection in one.detections],
        {source: masks for one in placed for source, masks in one.masks.items()},
        [source for one in placed for source in one.looked_at],
        total,
    )
    return _product(files)


def _read(task: StageTask, video: int, table: FrameTable) -> Annotations:
    size = table.info.width, table.info.height
    return load_annotations(task.recordings[video].annotations, size, task.settings.input.annotation_format)


def _product(files: Sequence[tuple[Annotations, PlacedAnnotations]]) -> AnnotationsProduct:
    """Of all files together; what each says of its time keys beside it where there are several videos."""
    total, summaries = len(files), [summarise(annotations, placed) for annotations, placed in files]
    conventions = [placed.convention.to_dict() for _, placed in files]
    labels = sum((Counter(summary.detections_by_label) for summary in summaries), Counter[str]())
    told = next((video for video, (annotations, _) in enumerate(files) if annotations.entries), 0)
    return AnnotationsProduct(
        format=", ".join(dict.fromkeys(summary.format for summary in summaries)),
        n_detections=sum(summary.n_detections for summary in summaries),
        n_keys=sum(summary.n_keys for summary in summaries),
        n_annotated_frames=sum(summary.n_annotated_frames or 0 for summary in summaries),
        n_without_frame=sum(d.source_index is None for _, placed in files for d in placed.detections),
        labels=dict(sorted(labels.items())),
        warnings=tuple(
            named(warning, video, total) for video, summary in enumerate(summaries) for warning in summary.warnings
        ),
        time_convention=conventions[told],
        flags=tuple(
            replace(flag, where=named(flag.where, video, total))
            for video, (_, placed) in enumerate(files)
            for flag in placed.flags
        ),
        time_conventions=tuple(conventions) if total > 1 else None,
    )
