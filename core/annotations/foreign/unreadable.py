"""What a file that is not read seems to be, and what can be done about it: one form of message for all of them."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from xml.etree.ElementTree import Element

from core.annotations.checks import parse_time, shown
from core.annotations.foreign import yolo
from core.annotations.foreign.formats import READABLE
from core.errors import BadInput

PAGE = "docs/annotations.md"
_CSV_NUMBERS = re.compile(r"\s*-?[0-9.]+(\s*,\s*-?[0-9.]+){5,9}\s*,?\s*")
_PARAMETERS = {"preset", "options", "label", "external_id"}
_VIDEO_STARTS = (b"\x1aE\xdf\xa3", b"OggS", b"FLV", b"\x00\x00\x01\xba", b"\x00\x00\x01\xb3", b"0&\xb2u", b".RMF")
_HEAD_BYTES = 512
"""Of a file, that tell a video or what is no text."""


def unreadable(what: str, advice: str = "", code: str = "annotations_unknown_format") -> BadInput:
    """The error for annotations that are not read.

    Args:
        what: what the file seems to be, with an article.
        advice: what to do, as a clause; empty for none.
        code: of the error.
    """
    hint = f"; {advice}" if advice else ""
    return BadInput(
        f"the annotations seem to be {what}{hint}. Read are {READABLE}, and our own form ({PAGE})",
        code=code,
        where="annotations",
    )


def looks_like_video(head: bytes) -> bool:
    """Whether a file that begins so is a video. Sixteen bytes decide."""
    riff = head.startswith(b"RIFF") and head[8:11] == b"AVI"
    stream = head.startswith(b"G") and len(head) > 188 and head[188:189] == b"G"
    return riff or stream or head[4:8] in (b"ftyp", b"moov", b"mdat", b"wide") or head.startswith(_VIDEO_STARTS)


def is_video_file(path: Path) -> bool:
    """Whether the file is a video by its first bytes; False for what cannot be read."""
    return looks_like_video(_head(path))


def is_text_file(path: Path) -> bool:
    """Whether the file begins as JSON or XML do; False for what cannot be read."""
    return _head(path).removeprefix(b"\xef\xbb\xbf").lstrip()[:1] in (b"{", b"[", b"<")


def _head(path: Path) -> bytes:
    """The first bytes of a file; none of what cannot be read."""
    try:
        with path.open("rb") as stream:
            return stream.read(_HEAD_BYTES)
    except OSError:
        return b""


def binary_kind(data: bytes) -> BadInput | None:
    """The error for what is no text and no zip; None for what may be text."""
    if looks_like_video(data[:_HEAD_BYTES]):
        return unreadable("a video", "the video and the annotations are in the wrong order?")
    if data.startswith(b"\x1f\x8b"):
        return unreadable("a file packed by gzip", "unpack it first")
    if data.startswith((b"7z\xbc\xaf", b"Rar!", b"BZh", b"\xfd7zXZ")) or data[257:262] == b"ustar":
        return unreadable("an archive of a kind that is not read", "pack it as a zip")
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        return None
    if b"\0" in data[:_HEAD_BYTES]:
        return unreadable("a binary file")
    return None


def text_kind(text: str) -> BadInput:
    """The error for text that is neither JSON nor XML."""
    lines = [line for line in text[:20_000].splitlines() if line.strip()][:20]
    if lines and all(yolo.is_label_text(line) for line in lines[:-1] or lines):
        return unreadable(
            "a text of YOLO for a single picture",
            "name the folder of all of them, or a zip of it, so that the names of the files say which frame each is",
        )
    if lines and all(_CSV_NUMBERS.fullmatch(line) for line in lines[:-1] or lines):
        return unreadable("a text of the MOT challenge, which names no classes", "convert it to COCO")
    if lines and lines[0].count(",") >= 2:
        return unreadable("a table (CSV)", "export JSON instead")
    return unreadable("text of another kind, no JSON and no XML", code="annotations_malformed")


def xml_kind(root: Element) -> BadInput:
    """The error for XML that no reader knows."""
    return unreadable(f"XML of another kind, with the root <{root.tag[:60]}>")


def json_kind(value: object) -> BadInput:
    """The error for JSON that no reader knows."""
    for looks_so, what, advice in _KINDS:
        if looks_so(value):
            return unreadable(what, advice)
    if isinstance(value, list):
        return unreadable("a JSON list of another kind")
    if isinstance(value, dict):
        key = next(iter(value), "")
        return unreadable(
            f"JSON of another kind: key {shown(key)} is not a time (seconds such as 12.5, or HH:MM:SS.fff)",
            code="bad_time",
        )
    return unreadable(f"JSON that is neither an object nor a list, but {shown(value)}")


def is_own(value: object) -> bool:
    """Whether a JSON value is of our own form: an object with a key that is a time, or without any."""
    return isinstance(value, dict) and (not value or any(_is_time(key) for key in value))


def _is_time(key: str) -> bool:
    try:
        parse_time(key)
    except BadInput as error:
        return error.code == "bad_time" and "negative" in error.message
    return True


def _all_have(*members: str) -> Callable[[object], bool]:
    """Whether a value is a list whose objects all have these members."""

    def looks_so(value: object) -> bool:
        listed = value if isinstance(value, list) else []
        return bool(listed) and all(isinstance(one, dict) and set(members) <= set(one) for one in listed)

    return looks_so


_KINDS: tuple[tuple[Callable[[object], bool], str, str], ...] = (
    (
        _all_have("image_id", "category_id"),
        "results of COCO alone",
        "they do not say what the pictures and categories are: add `images` and `categories`",
    ),
    (_all_have("image", "annotations"), "a file of CreateML", "export COCO instead"),
    (
        _all_have("key", "time_s", "label"),
        "the table detections.json of a result of this program",
        "name the annotations that the result was made from",
    ),
    (
        lambda value: isinstance(value, dict) and "videos" in value and "annotations" in value,
        "a file of YouTube-VIS",
        "convert it to COCO with `images`",
    ),
    (
        lambda value: isinstance(value, dict) and bool(value) and set(value) <= _PARAMETERS,
        "a file of parameters",
        "name it after --parameters",
    ),
    (
        lambda value: isinstance(value, dict) and "detections" in value and "schema_version" in value,
        "a file that this program wrote",
        "name the annotations that it was made from",
    ),
)
