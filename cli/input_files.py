"""The files beside the video that a command names: annotations, also as a folder of files, and a calibration."""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from core.annotations.foreign.archive import packed_folder
from core.calibration.files import read_calibration
from core.errors import BadInput
from core.settings.limits import MAX_BYTES, parse_limits

OPTION = "input.annotation_format"


@contextmanager
def annotation_file(path: Path) -> Iterator[Path]:
    """The file itself; a folder is packed into a zip that lives as long as the context, and is the same every time."""
    if not path.is_dir():
        yield path
        return
    with tempfile.TemporaryDirectory(prefix="bladeatlas-") as folder:
        packed = Path(folder, "annotations.zip")
        packed_folder(path, packed)
        yield packed


def with_format(parsed: argparse.Namespace) -> list[str]:
    """The options ``NAME=VALUE`` of a command, with what `--format` says as one of them."""
    return [*parsed.assignments, *([] if parsed.format is None else [f"{OPTION}={parsed.format}"])]


def calibration_options(path: Path | None) -> dict[str, object]:
    """The options that a calibration file stands for; none without one."""
    if path is None:
        return {}
    return read_calibration(path).options()


def limits_text(path: Path) -> str:
    """The table of limits in a file.

    Raises:
        BadInput: the file cannot be read or is no such table; the message names the line.
    """
    try:
        with path.open("rb") as stream:
            data = stream.read(MAX_BYTES + 1)
        text = data.decode("utf-8-sig")
    except OSError as error:
        raise BadInput(f"cannot read the table of limits: {error.strerror}", where=str(path)) from None
    except UnicodeDecodeError:
        raise BadInput("the table of limits is no text in UTF-8", where=str(path)) from None
    parse_limits(text)
    return text


def limit_options(path: Path | None) -> dict[str, object]:
    """The options that a table of limits stands for; none without one."""
    return {} if path is None else {"limits.table": limits_text(path)}


def add_limits(command: argparse.ArgumentParser) -> None:
    """Let a command take `--limits`."""
    text = "limits of the shop, CSV or JSON (docs/limits.md): every finding is compared with them"
    command.add_argument("--limits", type=Path, metavar="FILE", help=text)


def add_calibration(command: argparse.ArgumentParser) -> None:
    """Let a command take `--calibration`."""
    text = "lens of the source frame: a file of OpenCV, Kalibr or COLMAP; it is then held (docs/calibration.md)"
    command.add_argument("--calibration", type=Path, metavar="FILE", help=text)


def add_format(command: argparse.ArgumentParser) -> None:
    """Let a command take `--format`."""
    command.add_argument("--format", metavar="NAME", help=f"format of the annotations (told by content); sets {OPTION}")
