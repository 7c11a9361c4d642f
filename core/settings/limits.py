"""Limits of the shop: what damage a part may have, as a table that people write. Defaults are the preset `default`."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from pydantic import field_validator

from core.errors import BadInput
from core.scene.on_row import Side
from core.scene.size import MM_PER_INCH
from core.settings.base import Group, option

MAX_LIMITS = 1000
MAX_BYTES = 1 << 16
ANY = "any"
"""As a damage whatever its label, as a zone anywhere."""
ZONES = tuple(side for side in Side if side not in (Side.OTHER, Side.UNKNOWN))
"""Parts of a blade that a limit may be for; `edge` is for either edge."""


@dataclass(frozen=True)
class Limit:
    """One row of the table; what is None is not limited."""

    line: int
    """Of the file, from 1; of a JSON list the number of the entry."""
    zone: Side | None = None
    """One of `ZONES`; None is anywhere."""
    damage: str = ANY
    """Label of the findings that it is for, whatever the case of its letters."""
    span_from: float = 0.0
    """Least share of the span, from the root."""
    span_to: float = 1.0
    length_mm: float | None = None
    """Largest length of one finding."""
    depth_mm: float | None = None
    """Largest depth of one finding."""
    count: int | None = None
    """Most findings on one blade."""


_LENGTHS = ("length", "depth")
COLUMNS = ("zone", "damage", "span_from", "span_to", *(f"{name}_{unit}" for name in _LENGTHS for unit in ("mm", "in")))
"""Columns that a table may have, beside `count`; those that are left out limit nothing."""
_KNOWN = (*COLUMNS, "count")


def parse_limits(text: str) -> tuple[Limit, ...]:
    """The table of a text in CSV, with a header, or in JSON, a list of objects; both with the columns of `COLUMNS`.

    Raises:
        BadInput: it is no such table; the message names the line.
    """
    if len(text.encode()) > MAX_BYTES:
        raise BadInput(f"the table of limits is larger than {MAX_BYTES} bytes", where="limits")
    begins = text.lstrip("\ufeff \r\n\t")
    rows = list(_json_rows(begins) if begins.startswith(("[", "{")) else _csv_rows(text.lstrip("\ufeff")))
    if not rows:
        raise BadInput("the table of limits has no row", where="limits")
    if len(rows) > MAX_LIMITS:
        raise BadInput(f"the table of limits has more than {MAX_LIMITS} rows", where="limits")
    return tuple(_limit(line, cells) for line, cells in rows)


def _csv_rows(text: str) -> Iterator[tuple[int, dict[str, str]]]:
    """Line and cells, those that are empty left out."""
    reader = csv.reader(io.StringIO(text, newline=""), strict=True)
    header: list[str] = []
    try:
        for cells in reader:
            row = [cell.strip() for cell in cells]
            if not any(row):
                continue
            if not header:
                header = [name.lower() for name in row]
                _require_known(reader.line_num, header)
                continue
            if len(row) != len(header):
                raise _bad(reader.line_num, f"it has {len(row)} cells, the header has {len(header)}")
            yield reader.line_num, {name: cell for name, cell in zip(header, row, strict=True) if cell}
    except csv.Error as error:
        raise _bad(reader.line_num, str(error)) from None


def _json_rows(text: str) -> Iterator[tuple[int, dict[str, str]]]:
    try:
        rows = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise BadInput(f"the table of limits is no JSON: {error}", where="limits") from None
    if not isinstance(rows, list):
        raise BadInput("the table of limits must be a JSON list of objects, or CSV", where="limits")
    for number, row in enumerate(rows, start=1):
        if not isinstance(row, dict):
            raise _bad(number, "it is no object")
        _require_known(number, list(row))
        for name, value in row.items():
            if isinstance(value, bool | list | dict):
                raise _bad(number, f"{name} is neither a text nor a number")
        yield number, {name: str(value).strip() for name, value in row.items() if value is not None}


def _require_known(line: int, names: list[str]) -> None:
    for k, name in enumerate(names):
        if name not in _KNOWN:
            raise _bad(line, f"there is no column '{name}'; there are {', '.join(_KNOWN)}")
        if name in names[:k]:
            raise _bad(line, f"the column '{name}' is there twice")


def _limit(line: int, cells: Mapping[str, str]) -> Limit:
    zone = cells.get("zone", ANY).lower().replace(" ", "_")
    if zone not in (ANY, *ZONES):
        raise _bad(line, f"there is no zone '{cells['zone']}'; there are {', '.join((ANY, *ZONES))}")
    lengths = {f"{name}_mm": _length(line, cells, name) for name in _LENGTHS}
    count = _count(line, cells["count"]) if "count" in cells else None
    if count is None and not any(lengths.values()):
        raise _bad(line, "it limits nothing: give a length, a depth or a count")
    start, end = (
        _number(line, name, cells[name]) if name in cells else whole
        for name, whole in (("span_from", 0.0), ("span_to", 1.0))
    )
    if not 0.0 <= start < end <= 1.0:
        raise _bad(line, f"the span from {start:g} to {end:g} is none: 0 <= span_from < span_to <= 1")
    return Limit(line, zone_named(zone), cells.get("damage", ANY), start, end, **lengths, count=count)


def zone_named(name: str) -> Side | None:
    """The zone that a table, or ``limits.json``, names so; None is anywhere."""
    return None if name == ANY else Side(name)


def _length(line: int, cells: Mapping[str, str], name: str) -> float | None:
    """In mm; None where it is not limited."""
    told = [
        (f"{name}_{unit}", factor) for unit, factor in (("mm", 1.0), ("in", MM_PER_INCH)) if f"{name}_{unit}" in cells
    ]
    if not told:
        return None
    if len(told) > 1:
        raise _bad(line, f"{told[0][0]} and {told[1][0]} are both told: give one")
    ((column, factor),) = told
    value = _number(line, column, cells[column])
    if value <= 0.0:
        raise _bad(line, f"{column} is {value:g}, and has to be above 0")
    return factor * value


def _number(line: int, name: str, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise _bad(line, f"{name} is '{text}', which is no number")
    return value


def _count(line: int, text: str) -> int:
    if not (text.isascii() and text.isdecimal()):
        raise _bad(line, f"count is '{text}', which is no whole number from 0")
    return int(text)


def _bad(line: int, what: str) -> BadInput:
    return BadInput(f"line {line} of the table of limits: {what}", where=f"limits, line {line}")


class LimitSettings(Group):
    """What damage the shop allows; findings are compared with it, which changes nothing else of a result."""

    table: str | None = option(
        None,
        "table in CSV or JSON: rows of zone, damage, span_from, span_to, length_mm or length_in, depth_mm or depth_in, "
        "count; none = nothing is compared",
        source="user",
    )

    @field_validator("table")
    @classmethod
    def _readable(cls, table: str | None) -> str | None:
        try:
            if table is not None:
                parse_limits(table)
        except BadInput as error:
            raise ValueError(error.message) from None
        return table

    @property
    def rows(self) -> tuple[Limit, ...]:
        """Of the table; none without one."""
        return () if self.table is None else parse_limits(self.table)
