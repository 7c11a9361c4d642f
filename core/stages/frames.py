"""Stage `frames`: the frames that take part, cropped to the region of interest."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

import numpy as np

from core.flags import Flag, Severity
from core.frames.export import export_frames
from core.frames.sampling import ChosenFrame, Stretch, choose_frames, clip_interval
from core.io.annotations import read_detections
from core.io.frames import image_path, images_folder, write_frames
from core.products.front import FramesProduct
from core.roi import crop_of
from core.scene.frame import Crop, Frame, RunFrames, SourceFrame
from core.stage import StageTask
from core.video.still import find_still, write_still
from core.video.table import FrameTable, read_tables
from core.videos import named, naming_video


def run(task: StageTask) -> FramesProduct:
    """Write `images/`, `frames.json`, `damaged.json`, `crop.json` and `still.png`.

    Raises:
        BadInput: an impossible interval or region.
    """
    settings = task.settings
    tables = read_tables(task.input("probe"))
    crop = crop_of(settings.roi, tables[0].info.width, tables[0].info.height)
    stretches = _stretches(task, tables)
    chosen = choose_frames(stretches, settings.frames)
    images_folder(task.out).mkdir()
    for video, table in enumerate(tables):
        _export(task, video, table, [frame for frame in chosen if frame.source.video == video], crop)
    frames = RunFrames(tuple(_frame(one, tables[one.source.video]) for one in chosen))
    shown = sorted(chosen, key=lambda frame: frame.source)
    broken = {SourceFrame(video, i) for video, table in enumerate(tables) for i in table.info.damaged_pictures}
    damaged = [frame.index for frame in chosen if frame.source in broken]
    sound = [frame for frame in shown if frame.source not in broken] or shown
    still = find_still([image_path(task.out, frame.index) for frame in sound])
    flags = [
        replace(flag, where=named(flag.where, video, len(tables)))
        for video, stretch in enumerate(stretches)
        for flag in stretch.interval.flags
    ]
    if settings.frames.mask_still and still.share:
        flags.append(Flag("still_pixels_masked", Severity.INFO, still.share, 0.0, f"{still.frames} frames compared"))
    write_still(task.out, still.mask if settings.frames.mask_still else np.zeros_like(still.mask))
    write_frames(task.out, frames, crop, damaged)
    return FramesProduct(
        n_frames=len(chosen),
        n_damaged=len(damaged),
        n_search=frames.n_search,
        crop=(crop.x0, crop.y0, crop.x1, crop.y1),
        source_width=crop.source_width,
        source_height=crop.source_height,
        still_share=round(still.share, 6),
        flags=tuple(flags),
    )


def _stretches(task: StageTask, tables: Sequence[FrameTable]) -> list[Stretch]:
    """What may be chosen of every video; the interval of the settings is one of each video's own time."""
    settings, detections = task.settings, read_detections(task.input("annotations"))
    stretches = []
    for video, table in enumerate(tables):
        with naming_video(video, len(tables)):
            interval = clip_interval(table, settings.frames, settings.overrides)
        annotated = {d.source_index for d in detections if d.video == video and d.source_index is not None}
        reach = round(Fraction(settings.frames.neighbour_s) * table.info.average_rate)
        stretches.append(Stretch(interval, annotated, reach))
    return stretches


def _export(task: StageTask, video: int, table: FrameTable, chosen: Sequence[ChosenFrame], crop: Crop) -> None:
    until, total = max((frame.source.source_index for frame in chosen), default=0) + 1, len(task.recordings)
    export_frames(
        task.recordings[video].video,
        table,
        chosen,
        crop,
        images_folder(task.out),
        jpeg_quality=task.settings.frames.jpeg_quality,
        max_pixels=task.max_frame_pixels,
        on_frame=lambda done: task.report(video + done / until, total, named(f"frame {done} of {until}", video, total)),
    )


def _frame(one: ChosenFrame, table: FrameTable) -> Frame:
    row = table.rows[one.source.source_index]
    return Frame(one.index, row.index, row.pts, row.time_s, row.sha256, one.role, video=one.source.video)
