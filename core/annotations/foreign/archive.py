"""Zip files and folders of strangers: names and contents of their files, within limits."""

from __future__ import annotations

import io
import os
import struct
import zipfile
import zlib
from collections.abc import Iterator
from pathlib import Path

from core.annotations.checks import shown
from core.annotations.read import MAX_BYTES
from core.errors import BadInput

MAX_FILES = 100_000
MAX_RATIO = 400
"""Bytes a packed byte may become in a large file. Tables of numbers reach 50; only files made to hurt reach 1000."""
MAX_DIRECTORY = 16 * 1024 * 1024
"""Bytes of a zip's table of contents, which the library reads as a whole."""
_RATIO_FROM = 1 << 20
_MAX_NAME = 1024
_END = b"PK\x05\x06"
_END_64 = b"PK\x06\x07"
_END_REACH = (1 << 16) + 64
_HEAD = 512
_DAMAGED = (
    zipfile.BadZipFile,
    zlib.error,
    struct.error,
    EOFError,
    OSError,
    IndexError,
    ValueError,
    NotImplementedError,
    RuntimeError,
)
"""What the library raises for archives whose parts contradict each other; found by changing bytes of sound ones."""
_PICTURES = (b"\xff\xd8\xff", b"\x89PNG", b"II*\0", b"MM\0*", b"RIFF", b"GIF8")


def files_of_zip(data: bytes) -> Iterator[tuple[str, bytes | None]]:
    """Names and contents of the files of a zip, in its order; None for one that is no text, such as a picture.

    Raises:
        BadInput: `annotations_archive` for what is damaged, encrypted, packed in a way that is not read, or has
            names that lead elsewhere; `annotations_too_large` beyond the limits.
    """
    _require_directory(data)
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            members = [one for one in archive.infolist() if not one.is_dir() and not _hidden(one.filename)]
            if len(members) > MAX_FILES:
                raise _large(f"holds {len(members)} files; at most {MAX_FILES} are read")
            left = MAX_BYTES
            seen: set[str] = set()
            for member in members:
                _require_member(member, seen)
                with archive.open(member) as stream:
                    head = stream.read(_HEAD)
                    if _is_binary(head):
                        yield member.filename, None
                        continue
                    content = head + stream.read(left + 1)
                left -= len(content)
                if left < 0:
                    raise _large(f"holds more than {MAX_BYTES / 1e6:.0f} MB of text")
                yield member.filename, content
    except _DAMAGED:
        raise BadInput(
            "the archive of the annotations is damaged, or packed in a way that is not read",
            code="annotations_archive",
            where="annotations",
        ) from None


def _require_directory(data: bytes) -> None:
    """Refuse a table of contents that is too long before the library reads it."""
    tail = data[-_END_REACH:]
    at = tail.rfind(_END)
    if at < 0 or len(tail) < at + 22:
        raise BadInput("the archive of the annotations is cut off", code="annotations_archive", where="annotations")
    if _END_64 in tail or int.from_bytes(tail[at + 12 : at + 16], "little") > MAX_DIRECTORY:
        raise _large("has too long a table of contents")


def _is_binary(head: bytes) -> bool:
    """Whether a file that begins so is a picture, a video or the like, of which only the name is of use."""
    return head.startswith(_PICTURES) or b"\0" in head


def _hidden(name: str) -> bool:
    """Files that systems leave beside those of people."""
    return name.startswith("__MACOSX/") or name.rpartition("/")[2].startswith(".")


def _require_member(member: zipfile.ZipInfo, seen: set[str]) -> None:
    name = member.filename
    unsafe = name.startswith("/") or "\\" in name or ":" in name.split("/")[0] or ".." in name.split("/")
    if unsafe or len(name) > _MAX_NAME or name in seen:
        why = "occurs twice" if name in seen else "is no plain name"
        raise BadInput(
            f"the archive of the annotations cannot be used: the name {shown(name)} in it {why}",
            code="annotations_archive",
            where=shown(name),
        )
    seen.add(name)
    if member.flag_bits & 1:
        raise BadInput("the archive of the annotations is encrypted", code="annotations_archive", where=shown(name))
    if member.file_size > _RATIO_FROM and member.file_size > MAX_RATIO * max(1, member.compress_size):
        raise _large(f"unpacks {shown(name)} to more than {MAX_RATIO} times its size")


def packed_folder(folder: Path, target: Path) -> None:
    """Pack the files of a folder into a zip that is the same for the same files. Of pictures and videos only the
    names and beginnings are kept.

    Raises:
        BadInput: `annotations_too_large`, or a file cannot be read.
    """
    left, count = MAX_BYTES, 0
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for path in _walk(folder):
            count += 1
            if count > MAX_FILES:
                raise _large(f"holds more than {MAX_FILES} files", "folder")
            try:
                with path.open("rb") as stream:
                    content = stream.read(_HEAD)
                    if not _is_binary(content):
                        content += stream.read(left + 1)
            except OSError:
                raise BadInput(
                    f"the file '{path.name}' of the annotations may not be read",
                    code="unreadable_file",
                    where="annotations",
                ) from None
            left -= len(content)
            if left < 0:
                raise _large(f"holds more than {MAX_BYTES / 1e6:.0f} MB of text", "folder")
            # The earliest date that a zip can hold: the same files make the same archive on every day.
            info = zipfile.ZipInfo(path.relative_to(folder).as_posix(), (1980, 1, 1, 0, 0, 0))
            info.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(info, content)


def _walk(folder: Path) -> Iterator[Path]:
    """Regular files below a folder in the order of their names; links are not followed."""
    for parent, folders, names in os.walk(folder, followlinks=False):
        folders[:] = sorted(one for one in folders if not one.startswith("."))
        for name in sorted(names):
            path = Path(parent, name)
            if not name.startswith(".") and path.is_file() and not path.is_symlink():
                yield path


def _large(what: str, kind: str = "archive") -> BadInput:
    return BadInput(f"the {kind} of the annotations {what}", code="annotations_too_large", where="annotations")
