"""The videos that a command names, each with its annotations."""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from pathlib import Path

from cli.input_files import annotation_file
from core.errors import BadInput
from core.videos import Recording, require_count

NONE = "-"
"""Stands among annotation files for a video that has none."""


def add_recordings(command: argparse.ArgumentParser) -> None:
    """Let a command take videos and their annotations."""
    command.add_argument(
        "files",
        type=Path,
        nargs="+",
        metavar="VIDEO",
        help="file, folder or zip of pictures, pattern as f/%%04d.jpg; several are of one inspection, in order. "
        "Behind a single video its annotations may follow: file or folder, see docs/annotations.md",
    )
    command.add_argument(
        "--annotations",
        type=Path,
        nargs="+",
        metavar="FILE",
        help=f"annotations of every video, in the same order; {NONE} for a video without",
    )


@contextmanager
def recordings_of(parsed: argparse.Namespace) -> Iterator[list[Recording]]:
    """What the arguments of `add_recordings` name; folders of annotations are packed as long as the context lives.

    Raises:
        BadInput: there are not as many annotation files as videos, or more videos than an inspection may have.
    """
    with ExitStack() as stack:
        yield [
            Recording(
                one.video, None if one.annotations is None else stack.enter_context(annotation_file(one.annotations))
            )
            for one in paired(parsed.files, parsed.annotations)
        ]


@contextmanager
def as_files(recordings: Sequence[Recording]) -> Iterator[list[Recording]]:
    """The same with every folder or pattern of pictures packed into a zip that lives as long as the context.

    A server is sent files only.

    Raises:
        BadInput: there are no pictures, or one cannot be read.
    """
    from core.video.pictures import pack_pictures  # loads vision libraries, which `--help` does not need

    with tempfile.TemporaryDirectory(prefix="bladeatlas-") as folder:
        found = []
        for number, one in enumerate(recordings):
            # A folder of its own for each, so that the zip keeps the name of what was packed.
            packed = Path(folder, str(number), f"{one.video.name.replace('%', '')}.zip")
            packed.parent.mkdir()
            found.append(replace(one, video=packed) if pack_pictures(one.video, packed) else one)
        yield found


def paired(files: Sequence[Path], annotations: Sequence[Path] | None) -> list[Recording]:
    """Videos with their annotations.

    Without `annotations` the second of two files is the annotations of the first, unless its content is a video; of
    more files all are videos.

    Args:
        files: as they stand on the command line.
        annotations: what was given as such; None = nothing.
    """
    # Loaded here: it loads vision libraries, which `--help` does not need.
    from core.annotations.foreign.unreadable import is_text_file, is_video_file

    videos = list(files)
    if annotations is None:
        # Annotations before a video are in the wrong order, and no two videos: who reads them says so.
        alone = len(files) == 2 and (not is_video_file(files[1]) or is_text_file(files[0]))
        videos, annotations = (videos[:1], videos[1:]) if alone else (videos, [])
    require_count(len(videos))
    notes = [None if str(path) == NONE else path for path in annotations]
    if notes and len(notes) != len(videos):
        count = "1 annotation file" if len(notes) == 1 else f"{len(notes)} annotation files"
        raise BadInput(
            f"{count} for {len(videos)} video{'s' if len(videos) > 1 else ''}; give one for each, in order, and {NONE} "
            "for a video without",
            code="annotations_count",
            where="--annotations",
        )
    return [Recording(video, note) for video, note in zip(videos, notes or [None] * len(videos), strict=True)]
