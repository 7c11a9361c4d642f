"""Annotations put on frames: which source frame each time key means."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction

from core.annotations.checks import shown
from core.annotations.clocks import Clock, ruler_of
from core.annotations.convention import Fitted, fit_convention
from core.annotations.model import Annotations
from core.errors import BadInput
from core.flags import Flag, Severity
from core.scene.detection import Detection, Mask
from core.scene.frame import SourceFrame
from core.video.table import FrameTable

MAX_OUTSIDE_SHARE = 0.5
"""With more of the keys beyond the video, the annotations were made on another one."""
MAX_MISCOUNT = 0.02
"""Share of the frames that a tool may count too many or too few; with more, it went by another frame rate."""


@dataclass(frozen=True)
class PlacedAnnotations:
    """All detections by id; masks by source frame; and what the reader should know."""

    detections: tuple[Detection, ...]
    masks: dict[SourceFrame, tuple[Mask, ...]]
    keys_outside: tuple[str, ...]
    looked_at: tuple[SourceFrame, ...]
    """Source frames that have a key, with detections or without: the detector saw them."""
    flags: tuple[Flag, ...]
    convention: Fitted


def place(
    annotations: Annotations, table: FrameTable, convention: str = "auto", video: int = 0, first_id: int = 0
) -> PlacedAnnotations:
    """Give every key of a file its frame, by the convention that the keys of the file follow.

    Keys outside the video keep their detections, without a frame. A cut-off video has annotations beyond
    its end as a matter of course; otherwise many of them mean the wrong file.

    Args:
        annotations: of one file.
        table: frames of the video that it is of.
        convention: a clock, or ``auto``.
        video: number of that video.
        first_id: detections of the files before it: ids go on over the files of a run.

    Raises:
        BadInput: `annotations_beyond_video`, `annotation_times_unclear`.
    """
    if convention == "auto" and _counted_otherwise(annotations, table):
        annotations, convention = _retimed(annotations, table), "displayed"
    keys = {entry.key: entry.time for entry in annotations.entries}
    fitted = fit_convention(keys, table, convention, annotations.clocks)
    frames = fitted.reading.frames
    outside = tuple(key for key, frame in frames.items() if frame is None)
    allowed = 1.0 if table.info.truncated else MAX_OUTSIDE_SHARE
    if outside and (len(outside) > allowed * len(frames) or len(outside) == len(frames)):
        latest = max(annotations.entries, key=lambda entry: entry.time)
        raise BadInput(
            f"the annotations belong to another video: {len(outside)} of {len(frames)} time keys lie beyond its end "
            f"at {table.info.duration_s:.3f} s (the latest is {shown(latest.key)})",
            code="annotations_beyond_video",
            where=shown(outside[0]),
        )
    masks: dict[SourceFrame, tuple[Mask, ...]] = {}
    for entry in annotations.entries:
        frame = frames[entry.key]
        if frame is not None and entry.masks:
            source = SourceFrame(video, frame)
            masks[source] = (*masks.get(source, ()), *entry.masks)
    flags = fitted.flags
    if outside:
        where = f"first key {shown(outside[0])}"
        flags = (*flags, Flag("annotations_outside_video", Severity.WARNING, float(len(outside)), 0.0, where))
    if annotations.left_out:
        flags = (*flags, Flag("annotations_partly_read", Severity.INFO, where="; ".join(annotations.left_out)))
    return PlacedAnnotations(
        detections=tuple(
            replace(
                detection,
                id=detection.id + first_id,
                video=video,
                time_s=_seconds(entry.time, frames[entry.key], fitted.reading.clock, table),
                source_index=frames[entry.key],
            )
            for entry in annotations.entries
            for detection in entry.detections
        ),
        masks=masks,
        keys_outside=outside,
        looked_at=tuple(
            SourceFrame(video, frame) for frame in sorted({frame for frame in frames.values() if frame is not None})
        ),
        flags=flags,
        convention=fitted,
    )


def _counted_otherwise(annotations: Annotations, table: FrameTable) -> bool:
    """Whether the tool that numbered the frames took the video for one of another rate."""
    counted, there = annotations.n_frames, len(table.rows)
    return counted is not None and counted > 0 and abs(counted - there) > max(1.0, MAX_MISCOUNT * there)


def _retimed(annotations: Annotations, table: FrameTable) -> Annotations:
    """The same with times in s instead of the numbers, from 1, of frames that a tool spread evenly over the video."""
    step = Fraction(table.info.duration_s) / (annotations.n_frames or 1)
    entries = []
    for entry in annotations.entries:
        time = (entry.time - 1) * step
        detections = tuple(replace(one, time_s=float(time)) for one in entry.detections)
        entries.append(replace(entry, time=time, detections=detections))
    return replace(annotations, entries=tuple(entries))


def _seconds(value: Fraction, frame: int | None, clock: Clock, table: FrameTable) -> float:
    """Seconds from the first frame: what a key in such seconds says, else the time of its frame.

    Outside the video no frame has a time; there the key's distance from the first frame is counted in usual frames.
    """
    if clock in ("pts", "displayed"):
        return float(value)
    if frame is not None:
        return table.rows[frame].time_s
    ruler = ruler_of(clock, table)
    return float((value * ruler.unit - ruler.times[0]) / ruler.step / table.info.average_rate)
