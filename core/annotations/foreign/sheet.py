"""What a reader of a foreign format gives: shapes on pictures, and what it left out."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from core.annotations.checks import shown
from core.annotations.clocks import FRAME_NUMBERS, Clock
from core.errors import BadInput
from core.geometry.boxes import Box

Points = tuple[tuple[float, float], ...]
"""Corners (x, y) in the unit of their picture."""
Size = tuple[float, float]
"""Width and height."""

SHARES: Size = (1.0, 1.0)
"""Unit of coordinates that are shares of the picture already."""
PERCENT: Size = (100.0, 100.0)
"""Unit of coordinates in percent of the picture."""
MAX_SHAPES = 500_000
"""Shapes of a file, at most: as many as the largest file of our own form can hold. Tracks unfold into many."""
MAX_PIXELS = 1 << 34
"""Pixels of all masks of a file that are unpacked, at most: half a minute's work, ten thousand large masks."""
MAX_NUMBER = 10**9
"""Largest frame number. No video has as many frames; longer numbers in names are times of day or identifiers."""

FROM_ZERO: tuple[Clock, ...] = ("index",)
FROM_ONE: tuple[Clock, ...] = ("index+1",)
SECONDS: tuple[Clock, ...] = ("pts", "container")
"""Times of a player: of the video's own frames, or, where these do not fit, of what was on the screen."""

ANY_DROPS: Mapping[str, str] = {
    "no area": "shape without area",
    "outside": "shape outside of its picture",
    "no label": "shape without a label",
}
"""What no reader can use."""

_SUFFIXES = re.compile(r"(\.rf\.[0-9A-Za-z]+)?(\.(jpe?g|png|bmp|tiff?|webp|json|xml|txt))*$", re.IGNORECASE)
_MANGLED = re.compile(r"_(jpe?g|png|bmp|tiff?|webp)$", re.IGNORECASE)
_NUMBER = re.compile(r"[0-9]+")
_MAX_NAME = 1024
_HEAD = re.compile(r"(?=( (?:of|that|without|outside|in) .*)?$)")


@dataclass(frozen=True)
class Shape:
    """One thing that somebody drew, in the unit of its picture."""

    label: str
    box: Box | None = None
    """Left, upper, right, lower; None = that of the outline."""
    outline: Points | None = None
    score: float | None = None
    track_id: str | int | None = None


@dataclass
class Picture:
    """A picture that somebody looked at, with what was drawn on it; it may be empty."""

    key: str
    """Frame number, or seconds with a decimal point."""
    name: str
    """For messages."""
    unit: Size | None
    """What coordinates are divided by to be shares; None = the size of the video, because the file names none."""
    size: Size | None
    """Of the picture in pixels, where the file names it."""
    shapes: dict[Shape, None] = field(default_factory=dict)
    """In their order, each once: archives hold the same annotations in several files."""


class Sheet:
    """Collects the pictures of a file, or of all files of an archive."""

    def __init__(self, drops: Mapping[str, str]) -> None:
        """Start without pictures; `drops` says what of the format is not read, by kind."""
        self.pictures: dict[str, Picture] = {}
        self.clocks: tuple[Clock, ...] = FRAME_NUMBERS
        """By which the keys are read; of several, which one is fitted."""
        self.dropped: Counter[str] = Counter()
        self.counted_frames: int | None = None
        """Frames of the video as the tool counted them, where it says so."""
        self.notes: list[str] = []
        """Sentences on what was read in an unusual way."""
        self._drops = {**ANY_DROPS, **drops}
        self._left = MAX_SHAPES
        self._pixels_left = MAX_PIXELS

    def drop(self, kind: str, count: int = 1) -> None:
        """Count what is not read; `kind` is one of the format's table."""
        if kind not in self._drops:
            raise KeyError(kind)
        if count:
            self.dropped[kind] += count

    def spend(self, pixels: int) -> None:
        """Count the pixels of a mask that is going to be unpacked.

        Raises:
            BadInput: `annotations_too_large`; a few bytes stand for any number of pixels.
        """
        self._pixels_left -= pixels
        if self._pixels_left < 0:
            raise BadInput(
                f"the masks of the annotations have more than {MAX_PIXELS / 1e9:.0f} thousand million pixels",
                code="annotations_too_large",
                where="annotations",
            )

    def note(self, text: str) -> None:
        """Keep a sentence on how the file was read, once."""
        if text not in self.notes:
            self.notes.append(text)

    def add(
        self, key: str, name: str, shapes: Iterable[Shape] = (), *, unit: Size | None, size: Size | None = None
    ) -> None:
        """Put shapes on a picture.

        Args:
            key: frame number, or seconds.
            name: of the picture, for messages; the same key with another name is refused.
            shapes: what was drawn; none makes an empty picture.
            unit: what coordinates are divided by; None = the video's size.
            size: of the picture in pixels, when known.

        Raises:
            BadInput: two pictures have one number, or there are too many shapes.
        """
        picture = self.pictures.setdefault(key, Picture(key, name, unit, size))
        if picture.name != name:
            raise BadInput(
                f"two pictures of the annotations have the frame number {key}: {shown(picture.name)} and "
                f"{shown(name)}; annotations of one video at a time are read",
                code="annotations_several_videos",
                where=shown(name),
            )
        for shape in shapes:
            self._left -= 1
            if self._left < 0 or len(self.pictures) > MAX_SHAPES:
                raise BadInput(
                    f"the annotations hold more than {MAX_SHAPES} shapes or pictures",
                    code="annotations_too_large",
                    where="annotations",
                )
            picture.shapes[shape] = None

    @property
    def left_out(self) -> list[str]:
        """One sentence for each kind of thing that was not read."""
        return [f"{counted(self._drops[kind], count)} not read" for kind, count in self.dropped.items()]


def counted(what: str, count: int) -> str:
    """A number of things with its verb: "1 ellipse is", "12 ellipses are"."""
    return f"1 {what} is" if count == 1 else f"{count} {plural(what)} are"


def plural(what: str) -> str:
    """The plural of a thing: "ellipses", "boxes that are turned", "classes of a picture"."""
    head = _HEAD.split(what, maxsplit=1)[0]
    stem = head[:-1] + "ie" if head.endswith("y") else head + "e" if head.endswith(("x", "s", "sh", "ch")) else head
    return f"{stem}s{what[len(head) :]}"


def frame_number(value: int, name: str) -> str:
    """The key of a frame number that a file states.

    Raises:
        BadInput: it is negative or larger than any video is long.
    """
    if not 0 <= value <= MAX_NUMBER:
        raise BadInput(
            f"annotations: {name} is {value}, which is no frame number", code="annotations_frame_unknown", where=name
        )
    return str(value)


def number_in_name(name: str) -> str:
    """The key of a picture that is known by its file's name: the last number in it. A file alone has no name.

    Suffixes are no part of it, nor is what Roboflow appends (``frame_0007_jpg.rf.0a1b2c.jpg`` is 7).

    Raises:
        BadInput: there is no number, or one that is too large.
    """
    if not name:
        raise BadInput(
            "the annotations are of a single picture, and do not say which frame of the video it is; put the files of "
            "all pictures, named by their frames (such as frame_000012.json), into a folder or a zip",
            code="annotations_frame_unknown",
            where="annotations",
        )
    stem = _MANGLED.sub("", _SUFFIXES.sub("", name[:_MAX_NAME].replace("\\", "/").rpartition("/")[2]))
    numbers = _NUMBER.findall(stem)
    if len(name) > _MAX_NAME or not numbers or len(numbers[-1]) > len(str(MAX_NUMBER)) or int(numbers[-1]) > MAX_NUMBER:
        raise BadInput(
            f"annotations: the picture {shown(name)} has no frame number in its name; name pictures by the frame of "
            "the video that they show, such as frame_000012.png",
            code="annotations_frame_unknown",
            where=shown(name),
        )
    return str(int(numbers[-1]))


def seconds_key(seconds: float) -> str:
    """The key of a time, with a decimal point and at least three decimals, so that it is no frame number.

    Raises:
        BadInput: it is negative or longer than any video.
    """
    if not 0 <= seconds <= MAX_NUMBER:
        raise BadInput(f"annotations: {seconds:g} s is no time of a video", code="bad_time", where="annotations")
    return max(f"{seconds:.3f}", repr(round(seconds, 9)), key=len) if seconds >= 1e-4 else f"{seconds:.6f}"
