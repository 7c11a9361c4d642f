"""The frames of a run: which of the video take part and why, and the part of them that is exported."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from enum import StrEnum
from fractions import Fraction
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

from core.json_files import JsonObject
from core.videos import moment


class Role(StrEnum):
    """Why a frame takes part."""

    SAMPLED = "sampled"
    """One of the evenly spread frames."""
    ANNOTATED = "annotated"
    """It has a detection."""
    BOTH = "both"
    """Evenly spread, and with a detection."""
    NEIGHBOUR = "neighbour"
    """Next to an annotated frame that would otherwise be alone."""
    ADDED = "added"
    """Annotated as well, but beyond the budget of the search: registered afterwards."""


class SourceFrame(NamedTuple):
    """A decoded frame of one of the videos; in order, frames are those of one video after the other."""

    video: int
    """Number of the video, from 0 in the order given."""
    source_index: int
    """Decoded frame of that video, from 0."""


@dataclass(frozen=True)
class _FrameFields:
    """What a frame of the run and a row of ``frames.csv`` have in common, and begin with."""

    index: int
    """Number of the frame, from 0 by time, which names its image and counts in windows; it runs on over the videos, and
    frames registered afterwards continue the numbers."""
    source_index: int
    """Decoded frame of its video, from 0."""
    pts: int
    """Presentation time in the stream's time base."""
    time_s: float
    """Seconds from the first frame of its video, by its presentation time."""
    sha256: str
    """SHA-256 of the decoded RGB24 frame before deinterlacing, making its pixels square, and
    cropping."""
    role: Role
    """Why it takes part: `sampled`, `annotated`, `both`, `neighbour` or `added`."""


@dataclass(frozen=True)
class Frame(_FrameFields):
    """One frame of the run; the fields are the keys of its JSON form, in order."""

    video: int = 0
    """Number of its video, from 0 in the order given."""

    @property
    def source(self) -> SourceFrame:
        """Which frame of which video it is."""
        return SourceFrame(self.video, self.source_index)

    def to_dict(self) -> JsonObject:
        """JSON form."""
        return asdict(self)

    @classmethod
    def from_dict(cls, row: JsonObject) -> Frame:
        """From the JSON form; ValueError for a role that is not known."""
        return cls(**{**row, "role": Role(row["role"])})


@dataclass(frozen=True)
class FrameRow(_FrameFields):
    """One row of ``frames.csv``; the fields are its columns, in order."""

    registered: int
    """1 for a frame that is in a model, else 0."""
    model: int | None
    """Number of that model."""
    video: int = 0
    """Number of its video, from 0 in the order given."""

    def to_dict(self) -> JsonObject:
        """JSON form, keys in the order of the columns."""
        return asdict(self)


FRAME_COLUMNS: tuple[str, ...] = tuple(FrameRow.__dataclass_fields__)
"""Columns of ``frames.csv``."""


@dataclass(frozen=True)
class RunFrames:
    """The frame table of a run. `frames` are ordered by index, which is also their position."""

    frames: tuple[Frame, ...]

    def __len__(self) -> int:
        return len(self.frames)

    def __iter__(self) -> Iterator[Frame]:
        return iter(self.frames)

    def __getitem__(self, index: int) -> Frame:
        return self.frames[index]

    @cached_property
    def index_of_source(self) -> Mapping[SourceFrame, int]:
        """Index of each frame of the videos that takes part."""
        return {frame.source: frame.index for frame in self.frames}

    @cached_property
    def moment_of_index(self) -> Mapping[int, float]:
        """Time of each frame on the one axis of all videos (`core.videos.moment`), s."""
        return dict(enumerate(self.moments_s))

    @property
    def moments_s(self) -> list[float]:
        """The same in the order of the indices."""
        return [moment(frame.video, frame.time_s) for frame in self.frames]

    @property
    def videos(self) -> list[int]:
        """Video of each frame, in the order of the indices."""
        return [frame.video for frame in self.frames]

    @property
    def n_search(self) -> int:
        """Frames of the search: all but those that are registered afterwards."""
        return sum(frame.role != Role.ADDED for frame in self.frames)

    def timed_by_rate(self, rates: Sequence[Fraction]) -> RunFrames:
        """The same frames, each with its number in its video over that video's rate (frames per second) as its time."""
        fps = [float(rate) for rate in rates]
        return RunFrames(tuple(replace(frame, time_s=frame.source_index / fps[frame.video]) for frame in self.frames))


def frames_of(rows: Sequence[JsonObject]) -> RunFrames:
    """The frame table out of the JSON forms of its frames, in any order."""
    return RunFrames(tuple(sorted((Frame.from_dict(row) for row in rows), key=lambda frame: frame.index)))


def image_name(index: int) -> str:
    """File name of an exported frame, which is also its image's name in every model."""
    return f"{index:04d}.jpg"


def index_of_image(name: str) -> int:
    """Index of the frame that `image_name` gave the name of."""
    return int(Path(name).stem)


@dataclass(frozen=True)
class Crop:
    """The part of a source frame that is exported: x0 <= x < x1, y0 <= y < y1, in source pixels."""

    x0: int
    y0: int
    x1: int
    y1: int
    source_width: int
    source_height: int

    @property
    def width(self) -> int:
        """Columns of the exported frame."""
        return self.x1 - self.x0

    @property
    def height(self) -> int:
        """Rows of the exported frame."""
        return self.y1 - self.y0

    def to_dict(self) -> dict[str, int]:
        """JSON form, keys in the order of the fields."""
        return dict(self.__dict__)
