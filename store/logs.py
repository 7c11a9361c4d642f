"""Logs of an inspection's tasks: one file of lines per task, read on from where a reader was.

A cursor names the byte that was reached in every file, so a reader that follows running tasks gets every
line once, whichever task wrote it, and nothing is kept between two reads.
"""

from __future__ import annotations

import base64
import binascii
import json
import zlib
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import PurePosixPath
from typing import Any

from core.errors import BadInput
from core.task_key import key_of_stem
from store.files import ArtifactStore

FOLDER = "logs"
_SUFFIX = ".log"
_LONGEST_LINE = 1 << 16
"""A longer line comes in pieces of this many bytes."""
_LONGEST_CURSOR = 1 << 18


@dataclass(frozen=True)
class LogLine:
    """One line of one task."""

    task: str
    time: str | None
    """As written; that of the line before where a line has none, as in a traceback."""
    event: str
    """Name of the event, or the whole line when it is plain text."""
    fields: Mapping[str, Any] = field(default_factory=dict)
    """Whatever else the line says."""


@dataclass(frozen=True)
class LogPage:
    """Some lines, by time, and where to go on."""

    lines: tuple[LogLine, ...]
    cursor: str


@dataclass(frozen=True)
class InspectionLogs:
    """Logs below ``logs/<inspection id>/`` of a store."""

    store: ArtifactStore

    def read(self, inspection_id: str, after: str | None, limit: int, task: str | None = None) -> LogPage:
        """Up to `limit` lines behind a cursor; `BadInput` for a cursor that is none of ours."""
        reached = _decoded(after) if after else {}
        lines: list[LogLine] = []
        for path in self.store.list(f"{FOLDER}/{inspection_id}"):
            key = _task_of(path)
            if len(lines) < limit and path.endswith(_SUFFIX) and task in (None, key):
                reached[key] = self._read_file(path, key, reached.get(key, 0), limit - len(lines), lines)
        # Sorted within a page only: a line that comes late must not be lost behind one that is shown already.
        return LogPage(tuple(sorted(lines, key=lambda line: line.time or "")), _encoded(reached))

    def _read_file(self, path: str, key: str, start: int, limit: int, lines: list[LogLine]) -> int:
        """Append whole lines from byte `start` on; returns the byte behind the last one."""
        with suppress(FileNotFoundError), self.store.open(path) as stream:
            stream.seek(0, 2)
            if stream.tell() < start:  # a first attempt begins its log anew
                start = 0
            stream.seek(start)
            time: str | None = None
            for _ in range(limit):
                data = stream.readline(_LONGEST_LINE)
                if not data.endswith(b"\n") and len(data) < _LONGEST_LINE:
                    break  # still being written
                start += len(data)
                line = _line(key, data.decode("utf-8", "replace").rstrip("\n"), time)
                time = line.time
                lines.append(line)
        return start

    def paths(self, inspection_id: str) -> Iterator[str]:
        """Where the logs of an inspection lie in the store."""
        yield from self.store.list(f"{FOLDER}/{inspection_id}")


def _task_of(path: str) -> str:
    return key_of_stem(PurePosixPath(path).name.removesuffix(_SUFFIX))


def _line(task: str, text: str, before: str | None) -> LogLine:
    try:
        record = json.loads(text)
    except (ValueError, RecursionError):
        record = None
    if not isinstance(record, dict):
        return LogLine(task, before, text)
    time, event = record.pop("time", None), record.pop("event", "")
    return LogLine(task, str(time) if time is not None else before, str(event), record)


def _encoded(reached: Mapping[str, int]) -> str:
    text = json.dumps(reached, separators=(",", ":"), sort_keys=True)
    return base64.urlsafe_b64encode(zlib.compress(text.encode(), 9)).decode().rstrip("=")


def _decoded(cursor: str) -> dict[str, int]:
    try:
        packed = base64.urlsafe_b64decode(cursor + "=" * (-len(cursor) % 4))
        text = zlib.decompressobj().decompress(packed, _LONGEST_CURSOR)
        reached = json.loads(text)
        return {str(task): max(0, min(int(byte), 1 << 62)) for task, byte in reached.items()}
    except (ValueError, TypeError, AttributeError, OverflowError, RecursionError, binascii.Error, zlib.error):
        raise BadInput("this cursor was not given out by the service", code="bad_cursor", where="after") from None
