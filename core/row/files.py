"""``found.json``, ``blades.json`` and ``on_first.json``: what `row` and `blades` hand on, in full precision."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path

import numpy as np

from core.json_files import JsonObject, read_json, write_json
from core.row.blades import Sheet
from core.row.model import BladeRow, Coverage, EdgeName, NoRow, RowStatus, UnknownRow
from core.row.on_first import OnFirst
from core.row.overlap import Hypothesis
from core.row.passing import Leap
from core.row.regular import Irregularity
from core.row.section import Edge, Section
from core.row.turn import Axis
from core.scene.on_row import Side

_FOUND = "found.json"
_BLADES = "blades.json"
_ON_FIRST = "on_first.json"


def write_found(folder: Path, found: Hypothesis | NoRow) -> None:
    """Write the result of the search."""
    values = _unknown(found) if isinstance(found, NoRow) else {**_axis(found.axis), "pitch_rad": found.pitch_rad}
    write_json(folder / _FOUND, values)


def read_found(folder: Path) -> Hypothesis | NoRow:
    """Read what `write_found` wrote."""
    values = read_json(folder / _FOUND)
    return _no_row(values) if "reason" in values else Hypothesis(_read_axis(values), values["pitch_rad"])


def write_blades(folder: Path, row: BladeRow | NoRow) -> None:
    """Write the row of a model."""
    write_json(folder / _BLADES, _unknown(row) if isinstance(row, NoRow) else _row(row))


def read_blades(folder: Path) -> BladeRow | NoRow:
    """Read what `write_blades` wrote."""
    values = read_json(folder / _BLADES)
    return _no_row(values) if "reason" in values else _read_row(values)


def write_on_first(folder: Path, found: OnFirst) -> None:
    """Write how the row of a further model lies on that of the first, in the form of ``row.json``."""
    write_json(folder / _ON_FIRST, found.to_dict())


def read_on_first(folder: Path) -> JsonObject | None:
    """Read what `write_on_first` wrote; None in the result of the first model."""
    path = folder / _ON_FIRST
    document: JsonObject | None = read_json(path) if path.is_file() else None
    return document


def _unknown(row: NoRow) -> JsonObject:
    irregular = None if row.irregular is None else asdict(row.irregular)
    leap = None if row.leap is None else asdict(row.leap)
    return {"reason": str(row.reason), "contrast": row.contrast, "irregular": irregular, "leap": leap}


def _no_row(values: JsonObject) -> NoRow:
    pair = values["irregular"]
    irregular = None if pair is None else Irregularity(**{**pair, "blades": tuple(pair["blades"])})
    two = values["leap"]
    leap = None if two is None else Leap(**{**two, "frames": tuple(two["frames"])})
    return NoRow(UnknownRow(values["reason"]), values["contrast"], irregular, leap)


def _axis(axis: Axis) -> JsonObject:
    return {"axis": axis.direction.tolist(), "point": axis.foot.tolist()}


def _read_axis(values: JsonObject) -> Axis:
    return Axis(np.array(values["axis"]), np.array(values["point"]))


def _row(row: BladeRow) -> JsonObject:
    sheet, section = row.sheet, row.section
    plain = (
        "count",
        "root_radius",
        "tip_radius",
        "radius_sigma",
        "contrast",
        "pitch_sigma_rad",
        "zero_blade",
        "direction",
        "appears_rising",
    )
    return {
        **_axis(sheet.axis),
        "pitch_rad": sheet.pitch_rad,
        "sheet": {"lean": sheet.lean.tolist(), "middle": sheet.middle, "start": sheet.start_rad, "cut": sheet.cut_rad},
        "section": {
            "sides": [section.sides[1], section.sides[-1]],
            "edges": {name: None if edge is None else dict(edge.__dict__) for name, edge in section.edges.items()},
        },
        **{name: getattr(row, name) for name in plain},
        "status": str(row.status),
        "edge_a": str(row.edge_a),
        "overlaps": dict(row.overlaps),
        "numbers": [[index, number] for index, number in row.numbers.items()],
        "coverage": [{**one.__dict__, "by_views": list(one.by_views.items())} for one in row.coverage],
    }


def _read_row(values: JsonObject) -> BladeRow:
    sheet, section = values["sheet"], values["section"]
    edges = {name: None if edge is None else Edge(**edge) for name, edge in section["edges"].items()}
    sides = dict(zip((1, -1), map(Side, section["sides"]), strict=True))
    low, high = values["count"]
    height, radius = sheet["middle"]
    return BladeRow(
        status=RowStatus(values["status"]),
        sheet=Sheet(
            _read_axis(values),
            values["pitch_rad"],
            np.array(sheet["lean"]),
            (height, radius),
            sheet["start"],
            sheet["cut"],
        ),
        pitch_sigma_rad=values["pitch_sigma_rad"],
        count=(low, high),
        contrast=values["contrast"],
        overlaps=values["overlaps"],
        root_radius=values["root_radius"],
        tip_radius=values["tip_radius"],
        radius_sigma=values["radius_sigma"],
        numbers=dict(values["numbers"]),
        section=Section(sides, edges),
        coverage=tuple(Coverage(**{**one, "by_views": dict(one["by_views"])}) for one in values["coverage"]),
        edge_a=EdgeName(values["edge_a"]),
        zero_blade=values["zero_blade"],
        appears_rising=values["appears_rising"],
        direction=values["direction"],
    )
