"""The frame table: which frame was shown when, exactly. Everything that needs a frame's time asks here."""

from __future__ import annotations

import csv
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from pathlib import Path
from typing import Any, Literal

from core.errors import StageFailed
from core.geometry.nearest import nearest_index
from core.videos import count_videos, folder_of_video

_INFO = "video.json"
_TABLE = "table.csv"
_COLUMNS = ("index", "pts", "time_s", "keyframe", "sha256")

_RATIONALS = ("average_rate", "time_base", "sample_aspect_ratio")
_LISTS = ("damage", "joined", "streams", "damaged_pictures")

TimesFrom = Literal["file", "stream", "given", "assumed"]
"""Where times come from: the file holds them, or they are made from a rate that the stream's own header states, that
the user gave, or that had to be assumed."""


RATE_FROM: Mapping[TimesFrom, str] = {
    "stream": "as the stream's header states",
    "given": "as told",
    "assumed": "assumed: the file states none (input.fps)",
}
"""Where a rate comes from that times are made of, in words."""

_MAX_LISTED = 20


@dataclass(frozen=True)
class VideoInfo:
    """What is known of a video after decoding it once; sizes are those of the shown frame: turned, square pixels."""

    width: int
    height: int
    rotation_deg: int
    """Clockwise turn that the rotation flag asked for and that was applied."""
    mirrored: bool
    average_rate: Fraction
    """Frames per second."""
    time_base: Fraction
    """Seconds per unit of pts."""
    duration_s: float
    """From the first frame to the end of the last."""
    n_frames: int
    codec: str
    sha256: str
    """Of the file."""
    truncated: bool
    """Damaged; the table holds the decodable part."""
    damage: tuple[str, ...] = ()
    repaired_times: int = 0
    """Frames whose time in the file was missing or not after the one before."""
    joined: tuple[int, ...] = ()
    """Frames at which the stamps of the file start again: it was joined from several recordings."""
    stream: int | None = None
    """Number of the video stream among all streams of the file; None in results made before it was known."""
    streams: tuple[str, ...] = ()
    """The video streams of the file in words, where there are several."""
    declared_rate: Fraction | None = None
    """Frames per second as the file's header says, what OpenCV's ``CAP_PROP_FPS`` gives; None when it says nothing."""
    times_from: TimesFrom = "file"
    sample_aspect_ratio: Fraction = Fraction(1)
    """Width / height of a pixel as coded."""
    interlaced_frames: int = 0
    """Frames that are made of two fields."""
    field_order: str = ""
    """The field that is first (``tff``, ``bff``) where only the container says so."""
    damaged_pictures: tuple[int, ...] = ()
    """Frames whose picture is damaged though no other frame suffers from it; they stay in the table."""

    def to_dict(self) -> dict[str, object]:
        """The form of `video.json`; rationals as ``num/den``."""
        row = dict(self.__dict__)
        for name in _RATIONALS:
            row[name] = rational_text(row[name])
        for name in _LISTS:
            row[name] = list(row[name])
        row["declared_rate"] = None if self.declared_rate is None else rational_text(self.declared_rate)
        return row

    @classmethod
    def from_dict(cls, row: dict[str, Any]) -> VideoInfo:
        """Rebuild from what `to_dict` gave, as read from `video.json`."""
        row = dict(row)
        for name in _RATIONALS:
            if name in row:
                row[name] = Fraction(row[name])
        for name in _LISTS:
            row[name] = tuple(row.get(name, ()))
        declared = row.get("declared_rate")
        row["declared_rate"] = None if declared is None else Fraction(declared)
        return cls(**row)


def read_infos(folder: Path) -> list[VideoInfo]:
    """What is known of every video, from the result of `probe`."""
    return [_read_info(folder_of_video(folder, video)) for video in range(count_videos(folder))]


def _read_info(folder: Path) -> VideoInfo:
    return VideoInfo.from_dict(json.loads((folder / _INFO).read_text(encoding="utf-8")))


@dataclass(frozen=True)
class ListedFrame:
    """A row of the table: one decoded frame of the video."""

    index: int
    pts: int
    time_s: float
    """Seconds from the first frame, the float nearest to the exact time."""
    keyframe: bool
    sha256: str
    """Of the RGB24 bytes of the whole frame as decoded and turned, before fields are joined and pixels made square."""


@dataclass(frozen=True)
class FrameTable:
    """A video's facts and all its frames in presentation order, pts strictly increasing."""

    info: VideoInfo
    rows: tuple[ListedFrame, ...]

    @cached_property
    def _pts(self) -> list[int]:
        return [row.pts for row in self.rows]

    def time(self, index: int) -> Fraction:
        """Exact time of a frame in seconds from the first frame."""
        return (self._pts[index] - self._pts[0]) * self.info.time_base

    def nearest(self, time_s: Fraction) -> int:
        """Index of the frame nearest to a time; the earlier one when two are equally near."""
        units = time_s / self.info.time_base + self._pts[0]
        return nearest_index(self._pts, units)

    def frame_at(self, time_s: Fraction) -> int | None:
        """The frame nearest to a time within the video; None outside it.

        The video reaches from half a frame before its first frame up to one frame duration after its
        last (longer when the file says that the last frame stays on).
        """
        step = 1 / self.info.average_rate
        end = max(self.time(len(self.rows) - 1) + step, Fraction(self.info.duration_s))
        return self.nearest(time_s) if -step / 2 <= time_s < end else None

    def write(self, folder: Path) -> None:
        """Write `video.json` and `table.csv`."""
        (folder / _INFO).write_text(json.dumps(self.info.to_dict(), indent=1) + "\n", encoding="utf-8")
        with (folder / _TABLE).open("w", newline="", encoding="utf-8") as stream:
            writer = csv.writer(stream, lineterminator="\n")
            writer.writerow(_COLUMNS)
            for row in self.rows:
                writer.writerow((row.index, row.pts, repr(row.time_s), int(row.keyframe), row.sha256))

    @classmethod
    def read(cls, folder: Path) -> FrameTable:
        """Read what `write` wrote; `StageFailed` when the two files do not belong together."""
        info = _read_info(folder)
        with (folder / _TABLE).open(newline="", encoding="utf-8") as stream:
            rows = tuple(
                ListedFrame(int(r["index"]), int(r["pts"]), float(r["time_s"]), r["keyframe"] == "1", r["sha256"])
                for r in csv.DictReader(stream)
            )
        if len(rows) != info.n_frames:
            raise StageFailed(f"frame table has {len(rows)} rows for {info.n_frames} frames", where="probe")
        return cls(info, rows)


def read_tables(folder: Path) -> list[FrameTable]:
    """The frame tables of all videos, from the result of `probe`."""
    return [FrameTable.read(folder_of_video(folder, video)) for video in range(count_videos(folder))]


def colon_text(ratio: Fraction) -> str:
    """``num:den``, as shares of pixels are written."""
    return f"{ratio.numerator}:{ratio.denominator}"


def listed(frames: Sequence[int]) -> str:
    """Numbers of frames, the first ones when there are many."""
    further = f" and {len(frames) - _MAX_LISTED} further" if len(frames) > _MAX_LISTED else ""
    return ", ".join(map(str, frames[:_MAX_LISTED])) + further


def rational_text(value: Fraction) -> str:
    """``num/den``, also for whole numbers."""
    return f"{value.numerator}/{value.denominator}"
