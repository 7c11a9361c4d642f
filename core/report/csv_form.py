"""The one form of every CSV that is written, served or read: RFC 4180, and no text that a spreadsheet would run.

Labels and time keys come from the annotation file. A spreadsheet takes a cell that begins with one of
`= + - @`, a tab or a carriage return for a formula, so such a text gets an apostrophe in front. A text that
already has apostrophes before such a character gets one more: taking one away always gives the text back.
Numbers are no text: -3.5 stays -3.5.
"""

from __future__ import annotations

import csv
import io
import math
import re
from collections.abc import Iterator, Sequence
from pathlib import Path

_RUN = re.compile(r"'*[=+\-@\t\r]")
"""How a text begins that a spreadsheet would run, however often it was escaped."""
_ESCAPED = re.compile(r"'+[=+\-@\t\r]")


def escaped(text: str) -> str:
    """The text as a cell that no spreadsheet runs."""
    return f"'{text}" if _RUN.match(text) else text


def unescaped(cell: str) -> str:
    """The text that `escaped` was given; a number's cell comes back as it is."""
    return cell[1:] if _ESCAPED.match(cell) else cell


def csv_line(values: Sequence[object]) -> str:
    """One record with its CRLF: `.` decimals, 1 and 0 for true and false, empty for unknown.

    Raises:
        ValueError: a number is not finite.
    """
    line = io.StringIO(newline="")
    csv.writer(line, lineterminator="\r\n").writerow([_cell(value) for value in values])
    return line.getvalue()


def read_csv(path: Path) -> Iterator[dict[str, str]]:
    """Rows of a CSV that `csv_line` made, by column; texts are as they were before they became cells."""
    with path.open(newline="", encoding="utf-8") as stream:
        for row in csv.DictReader(stream):
            yield {name: unescaped(cell) for name, cell in row.items()}


def _cell(value: object) -> str:
    if value is None:
        return ""
    if isinstance(value, str):
        return escaped(value)
    if isinstance(value, bool):
        return str(int(value))
    if isinstance(value, float):
        if not math.isfinite(value):
            raise ValueError("a number is not finite")
        return repr(value)
    return str(value)
