"""Stage `frames`: the frames that take part, cropped to the region of interest."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from core.flags import Flag, Severity
from core.frames.export import export_frames
from core.frames.sampling import choose_frames, clip_interval
from core.io.annotations import read_detections
from core.io.frames import image_path, images_folder, write_frames
from core.roi import crop_of
from core.scene.frame import Frame, RunFrames
from core.stage import StageResult, StageTask
from core.video.still import find_still, write_still
from core.video.table import FrameTable


def run(task: StageTask) -> StageResult:
    """Write `images/`, `frames.json`, `damaged.json`, `crop.json` and `still.png`.

    Raises:
        BadInput: an impossible interval or region.
    """
    settings = task.settings
    table = FrameTable.read(task.input("probe"))
    detections = read_detections(task.input("annotations"))
    crop = crop_of(settings.roi, table.info.width, table.info.height)
    interval = clip_interval(table, settings.frames, settings.overrides)
    annotated = {d.source_index for d in detections if d.source_index is not None}
    reach = round(Fraction(settings.frames.neighbour_s) * table.info.average_rate)
    chosen = choose_frames(interval, annotated, settings.frames, reach)
    until = max(frame.source_index for frame in chosen) + 1

    images = images_folder(task.out)
    images.mkdir()
    export_frames(
        task.video,
        table,
        chosen,
        crop,
        images,
        jpeg_quality=settings.frames.jpeg_quality,
        max_pixels=task.max_frame_pixels,
        on_frame=lambda done: task.report(done, until, f"frame {done} of {until}"),
    )
    decoded = [table.rows[frame.source_index] for frame in chosen]
    frames = RunFrames(
        tuple(
            Frame(one.index, one.source_index, row.pts, row.time_s, row.sha256, one.role)
            for one, row in zip(chosen, decoded, strict=True)
        )
    )
    shown = sorted(chosen, key=lambda frame: frame.source_index)
    broken = set(table.info.damaged_pictures)
    damaged = [frame.index for frame in chosen if frame.source_index in broken]
    sound = [frame for frame in shown if frame.source_index not in broken] or shown
    still = find_still([image_path(task.out, frame.index) for frame in sound])
    flags = list(interval.flags)
    if settings.frames.mask_still and still.share:
        flags.append(Flag("still_pixels_masked", Severity.INFO, still.share, 0.0, f"{still.frames} frames compared"))
    write_still(task.out, still.mask if settings.frames.mask_still else np.zeros_like(still.mask))
    write_frames(task.out, frames, crop, damaged)
    return StageResult(
        {
            "n_frames": len(chosen),
            "n_damaged": len(damaged),
            "n_search": frames.n_search,
            "crop": [crop.x0, crop.y0, crop.x1, crop.y1],
            "source_width": crop.source_width,
            "source_height": crop.source_height,
            "still_share": round(still.share, 6),
            "flags": [flag.to_dict() for flag in flags],
        }
    )
