"""Pictures that together make a video: a folder of them, a pattern of their names, or a zip."""

from __future__ import annotations

import hashlib
import re
import zipfile
import zlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from core.errors import BadInput
from core.files import require_file
from core.fingerprint import digest_of_file
from core.video.formats import PICTURE_CODECS

MAX_PICTURES = 200_000
MAX_PICTURE_BYTES = 512 << 20
"""Of one picture, unpacked."""
_MAX_NAME = 255
_PATTERN = re.compile(r"%0?\d{0,2}d")
_DIGITS = re.compile(r"(\d+)")
_ZIP = b"PK\x03\x04"
_UNSEEN = ("__MACOSX",)
"""Folders that packers add."""


@dataclass(frozen=True)
class PictureFiles:
    """The pictures of a video, in order; use as a context manager while they are read."""

    source: Path
    names: tuple[str, ...]
    """In natural order: ``2.png`` before ``10.png``."""
    zipped: zipfile.ZipFile | None = None

    def __enter__(self) -> PictureFiles:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Close the zip."""
        if self.zipped is not None:
            self.zipped.close()

    def read(self, name: str) -> bytes:
        """Bytes of a picture; `BadInput` when it cannot be read or is larger than `MAX_PICTURE_BYTES`."""
        try:
            if self.zipped is None:
                path = self.source / name
                if path.stat().st_size > MAX_PICTURE_BYTES:
                    raise _too_large(name)
                return path.read_bytes()
            with self.zipped.open(name) as stream:
                data = stream.read(MAX_PICTURE_BYTES + 1)
        except (OSError, RuntimeError, ValueError, EOFError, zipfile.BadZipFile, zlib.error) as error:
            message = f"the picture '{name}' of '{self.source.name}' cannot be read ({type(error).__name__})"
            raise BadInput(message, code="unreadable_file", where="video") from None
        if len(data) > MAX_PICTURE_BYTES:
            raise _too_large(name)
        return data


def find_pictures(path: Path) -> PictureFiles | None:
    """The pictures that a path means; None when it is a file of another kind or nothing at all.

    Args:
        path: a folder, a pattern such as ``frames/%04d.jpg``, or a zip.

    Raises:
        BadInput: `no_pictures` or `not_a_file` when there are none, `pictures_unclear` when they lie in several
            folders of a zip, `too_many_frames`.
    """
    try:
        folder, file = path.is_dir(), path.is_file()
    except OSError:
        return None  # a name that no file can have
    if folder:
        return _of_folder(path)
    if not file and _PATTERN.search(path.name):
        return _of_pattern(path)
    return _of_zip(path) if file and _is_zip(path) else None


def digest_of_video(path: Path) -> str:
    """SHA-256 (hex) that names a video by its content.

    That of the file; for a folder or a pattern that of the text which ``sha256sum`` prints of the pictures in order:
    a line ``<sha256>  <name>`` for each.

    Raises:
        BadInput: of `find_pictures`, or a file error of `core.files.require_file`.
    """
    pictures = find_pictures(path)
    if pictures is None or pictures.zipped is not None:
        if pictures is not None:
            pictures.close()
        require_file(path, "video")
        return digest_of_file(path)
    whole = hashlib.sha256()
    for name in pictures.names:
        whole.update(f"{hashlib.sha256(pictures.read(name)).hexdigest()}  {name}\n".encode())
    return whole.hexdigest()


def pack_pictures(path: Path, target: Path) -> bool:
    """Put the pictures of a folder or a pattern into one zip, the same bytes for the same pictures on every day.

    Args:
        path: what a command names as a video.
        target: the zip to write.

    Returns:
        False, and nothing written, where `path` is a file already.

    Raises:
        BadInput: of `find_pictures`, or a picture that cannot be read.
    """
    pictures = find_pictures(path)
    if pictures is None or pictures.zipped is not None:
        if pictures is not None:
            pictures.close()
        return False
    with zipfile.ZipFile(target, "w", zipfile.ZIP_STORED) as archive:
        for name in pictures.names:
            # Without a date an entry has the first that a zip can hold.
            archive.writestr(zipfile.ZipInfo(name), pictures.read(name))
    return True


def natural_key(name: str) -> tuple[Sequence[tuple[int, str]], str]:
    """Sorts names by the numbers in them; of names with equal numbers, by their characters."""
    parts = _DIGITS.split(name)
    return [(int(part), "") if i % 2 else (-1, part) for i, part in enumerate(parts)], name


def _of_folder(path: Path) -> PictureFiles:
    try:
        found = [one.name for one in path.iterdir() if is_picture(one.name) and one.is_file()]
    except OSError as error:
        message = f"the folder '{path.name}' cannot be read: {error.strerror}"
        raise BadInput(message, code="unreadable_file", where="video") from None
    if not found:
        raise BadInput(
            f"the video '{path.name}' is a directory without pictures ({_suffixes()})", code="not_a_file", where="video"
        )
    return PictureFiles(path, _in_order(found, path.name))


def _of_pattern(path: Path) -> PictureFiles:
    before, after = _PATTERN.split(path.name, maxsplit=1)
    wanted = re.compile(re.escape(before) + r"\d+" + re.escape(after))
    folder = path.parent
    names = [one.name for one in folder.iterdir()] if folder.is_dir() else []
    found = [name for name in names if wanted.fullmatch(name)]
    if not found:
        raise BadInput(f"no file has a name like '{path.name}'", code="missing_file", where="video")
    if not is_picture(found[0]):
        raise BadInput(f"'{found[0]}' is no picture ({_suffixes()})", code="no_pictures", where="video")
    return PictureFiles(folder, _in_order(found, path.name))


def _of_zip(path: Path) -> PictureFiles:
    require_file(path, "video")
    try:
        zipped = zipfile.ZipFile(path)
    except (OSError, ValueError, NotImplementedError, zipfile.BadZipFile):
        raise BadInput(f"the zip '{path.name}' is damaged", code="unreadable_file", where="video") from None
    try:
        found = [one.filename for one in zipped.infolist() if not one.is_dir() and _is_seen(one.filename)]
        if not found:
            raise BadInput(
                f"the zip '{path.name}' holds no pictures ({_suffixes()})", code="no_pictures", where="video"
            )
        if len({PurePosixPath(name).parent for name in found}) > 1 or len(set(found)) < len(found):
            raise BadInput(
                f"the pictures in the zip '{path.name}' lie in several folders, or several have one name",
                code="pictures_unclear",
                where="video",
            )
        return PictureFiles(path, _in_order(found, path.name), zipped)
    except BadInput:
        zipped.close()
        raise


def is_picture(name: str) -> bool:
    """Whether a file of this name is one of the pictures: by its suffix, and not hidden."""
    return not name.startswith(".") and name.rpartition(".")[2].lower() in PICTURE_CODECS


def _is_seen(name: str) -> bool:
    parts = PurePosixPath(name).parts
    return bool(parts) and not set(parts) & set(_UNSEEN) and is_picture(parts[-1])


def _in_order(names: Iterable[str], source: str) -> tuple[str, ...]:
    found = list(names)
    if len(found) > MAX_PICTURES:
        message = f"'{source}' holds {len(found):,} pictures; at most {MAX_PICTURES:,} are read"
        raise BadInput(message, code="too_many_frames", where="video")
    if any(len(name.encode()) > _MAX_NAME for name in found):
        message = f"a picture of '{source}' has a name of more than {_MAX_NAME} bytes"
        raise BadInput(message, code="unreadable_file", where="video")
    return tuple(sorted(found, key=natural_key))


def _is_zip(path: Path) -> bool:
    try:
        with path.open("rb") as stream:
            return stream.read(len(_ZIP)) == _ZIP
    except OSError:
        return False


def _suffixes() -> str:
    return ", ".join(PICTURE_CODECS)


def _too_large(name: str) -> BadInput:
    return BadInput(
        f"the picture '{name}' has more than {MAX_PICTURE_BYTES >> 20} MiB", code="too_large", where="video"
    )
