"""Writer of the published tables in RFC 4180 CSV."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from core.report.csv_form import csv_line

SCHEMA_VERSION = 1


def write_csv(path: Path, columns: Sequence[str], rows: Sequence[Mapping[str, object]]) -> None:
    """Write a header and rows in the form of `core.report.csv_form`.

    Raises:
        ValueError: a row lacks a column or has a number that is not finite.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", encoding="utf-8", newline="") as stream:
        stream.write(csv_line(columns))
        for row in rows:
            missing = [name for name in columns if name not in row]
            if missing:
                raise ValueError(f"{path.name}: row without {', '.join(missing)}")
            try:
                stream.write(csv_line([row[name] for name in columns]))
            except ValueError as error:
                raise ValueError(f"{path.name}: {error}") from None
