"""Writers of the published tables: RFC 4180 CSV and finite JSON."""

from __future__ import annotations

import csv
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

SCHEMA_VERSION = 1


def write_json(path: Path, value: Any) -> None:
    """Write JSON in UTF-8, keys in their given order; ValueError for a number that is not finite."""
    text = json.dumps(value, ensure_ascii=False, allow_nan=False, indent=1)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text + "\n", encoding="utf-8", newline="\n")


def read_json(path: Path) -> Any:
    """Read a JSON file in UTF-8."""
    return json.loads(path.read_text(encoding="utf-8"))


def write_csv(path: Path, columns: Sequence[str], rows: Sequence[Mapping[str, Any]]) -> None:
    """Write rows as RFC 4180: a header, CRLF line ends, `.` decimals, empty for unknown.

    Raises:
        ValueError: a row lacks a column or has a number that is not finite.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\r\n")
        writer.writerow(columns)
        for row in rows:
            missing = [name for name in columns if name not in row]
            if missing:
                raise ValueError(f"{path.name}: row without {', '.join(missing)}")
            writer.writerow([_cell(row[name], path.name) for name in columns])


def _cell(value: Any, where: str) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return str(int(value))
    if isinstance(value, float):
        if value != value or value in (float("inf"), float("-inf")):
            raise ValueError(f"{where}: a number is not finite")
        return repr(value)
    return str(value)
