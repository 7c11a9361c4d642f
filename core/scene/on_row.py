"""Where on the row of blades a place lies, as columns of the tables."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, fields
from enum import StrEnum

from core.json_files import JsonObject

OF_FURTHER = re.compile(r"(\d{1,3})-B(\d{1,3})")
"""A blade of a further model by that model's own numbers: number of the model, number of the blade."""


class Side(StrEnum):
    """Which part of a blade a place lies on."""

    CONCAVE = "concave"
    CONVEX = "convex"
    LEADING_EDGE = "leading_edge"
    TRAILING_EDGE = "trailing_edge"
    EDGE = "edge"
    """One of the two edges, of which nobody told whether it is the leading one."""
    TIP = "tip"
    PLATFORM = "platform"
    OTHER = "other"
    """The surface of a row, but of none of its blades."""
    UNKNOWN = "unknown"


@dataclass(frozen=True)
class RowColumns:
    """Columns that say where on a blade a place lies, all empty while no row is known; the fields are their names."""

    side: Side | None = None
    """Part of the blade: `concave`, `convex`, `leading_edge`, `trailing_edge`, `edge`, `tip`; `platform`, `other` or
    `unknown`."""
    span: float | None = None
    """Place from root (0) to tip (1), of what was seen of the blades."""
    span_sigma: float | None = None
    """Standard deviation of the span."""
    chord: float | None = None
    """Place from leading (0) to trailing edge (1); only where both were seen and it was told which is which."""
    chord_sigma: float | None = None
    """Standard deviation of the chord."""
    edge_distance: float | None = None
    """Distance along the chord to the nearest edge that was seen, in `length_unit`."""
    edge_distance_sigma: float | None = None
    """Standard deviation of the distance to the edge."""
    root_distance: float | None = None
    """Distance from the root along the radius, in `length_unit`."""
    root_distance_sigma: float | None = None
    """Standard deviation of the distance from the root."""

    @classmethod
    def from_dict(cls, row: JsonObject) -> RowColumns:
        """From a row of a table; columns that an older one lacks are empty."""
        side = row.get("side")
        values = {name: row.get(name) for name in ROW_COLUMNS if name != "side"}
        return cls(side=None if side is None else Side(side), **values)


def blade_name(number: int | str, model: int, on_first: JsonObject | None) -> str:
    """A blade as the tables name it: by the first model's numbers, or by its own with the model's before them.

    Args:
        number: of the blade in its model.
        model: number of the model.
        on_first: of a further model, how it lies on the row of the first (the member of ``row.json``).
    """
    if not model:
        return str(number)
    return _names(on_first).get(str(number), f"{model}-B{number}")


def blade_number(name: str, on_first: JsonObject | None) -> int:
    """The number in its own model of a blade that the tables name: what `blade_name` was made of.

    Args:
        name: of a blade of that model.
        on_first: as of `blade_name`; None for the first model.

    Raises:
        ValueError: no blade has this name.
    """
    of_further = OF_FURTHER.fullmatch(name)
    if of_further is not None:
        return int(of_further[2])
    own = {of_first: number for number, of_first in _names(on_first).items()}
    return int(own.get(name, name))


def _names(on_first: JsonObject | None) -> Mapping[str, str]:
    """Numbers on the first model's row by the model's own; empty for what is not known to lie on it."""
    names: Mapping[str, str] = (on_first or {}).get("names", {})
    return names


NOT_ON_A_ROW = RowColumns()
"""All of them empty."""
ROW_COLUMNS: tuple[str, ...] = tuple(field.name for field in fields(RowColumns))
"""Columns of the place on the row."""
