"""The videos of one run: they are numbered from 0 in the order given, and this says where and how the number appears.

A stage that leaves files of each video keeps those of the first in its folder and those of a further one in a folder
below it that is named by the number, so that the result of one video is the same whether there could be more or not.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from math import floor
from pathlib import Path
from typing import TypedDict

from core.errors import BadInput
from core.json_files import JsonObject

MAX_VIDEOS = 16
"""More videos are never one inspection."""

APART_S = 1e6
"""Seconds from the start of one video to that of the next on the time axis of a run (`moment`). Longer than any video,
so that no rule about frames that are near each other in time reaches over a cut between two videos."""


class RecordingFields(TypedDict):
    """A `Recording` in JSON: paths as text."""

    video: str
    annotations: str | None


@dataclass(frozen=True)
class Recording:
    """A video and the annotations of it."""

    video: Path
    annotations: Path | None = None

    def to_dict(self) -> RecordingFields:
        """JSON form."""
        return {"video": str(self.video), "annotations": None if self.annotations is None else str(self.annotations)}

    @classmethod
    def from_dict(cls, fields: RecordingFields) -> Recording:
        """From the JSON form."""
        annotations = fields["annotations"]
        return cls(Path(fields["video"]), None if annotations is None else Path(annotations))


def moment(video: int, time_s: float) -> float:
    """Time on the one axis of all videos of a run, s; of the first video it is the time in the video itself."""
    return video * APART_S + time_s


def video_of(moment_s: float) -> int:
    """The video that a time on that axis is in."""
    return max(0, floor(moment_s / APART_S))


def folder_of_video(folder: Path, video: int) -> Path:
    """Folder of the files of one video in the result of a stage."""
    return folder / str(video) if video else folder


def count_videos(folder: Path) -> int:
    """How many videos have files in the result of a stage that keeps them by `folder_of_video`."""
    count = 1
    while folder_of_video(folder, count).is_dir():
        count += 1
    return count


def input_role(role: str, video: int) -> str:
    """Name of an input file: `role` (``video`` or ``annotations``), with the number of a further video behind it."""
    return f"{role}_{video}" if video else role


def unless_first(row: JsonObject) -> JsonObject:
    """A row of a stage's file without the number of its video when that is 0, as it was before there were several.

    So results of one video keep their digests, and nothing that was made of them is computed anew.
    """
    return {name: value for name, value in row.items() if name != "video" or value}


def named(text: str, video: int, n_videos: int) -> str:
    """A text with the video that it is about, where there are several."""
    if n_videos == 1:
        return text
    return f"video {video}: {text}" if text else f"video {video}"


@contextmanager
def naming_video(video: int, n_videos: int) -> Iterator[None]:
    """Errors about the input that leave the block name the video, where there are several."""
    try:
        yield
    except BadInput as error:
        if n_videos == 1:
            raise
        raise BadInput(named(error.message, video, n_videos), code=error.code, where=error.where) from None


def require_one_size(sizes: Sequence[tuple[int, int]]) -> None:
    """Refuse videos whose frames, as shown, differ in size: one probe with one lens makes frames of one size.

    Args:
        sizes: width and height in px of the frames of every video.

    Raises:
        BadInput: `video_sizes_differ`; names the first video and the first that differs.
    """
    for video, size in enumerate(sizes):
        if size != sizes[0]:
            first, other = (f"{width}x{height}" for width, height in (sizes[0], size))
            raise BadInput(
                f"the videos are not of one size: video 0 has frames of {first}, video {video} of {other}; "
                "one inspection is made with one probe",
                code="video_sizes_differ",
                where="video",
            )


def require_count(n_videos: int) -> None:
    """`BadInput` for more videos than one inspection may have, or none."""
    if not 1 <= n_videos <= MAX_VIDEOS:
        raise BadInput(f"{n_videos} videos; an inspection has 1 to {MAX_VIDEOS}", code="too_many_videos", where="video")
