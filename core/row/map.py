"""``row_map.svg``: the arc of the blades that were seen, with their coverage and the findings on them.

It is a scheme, not a projection: every blade has a cell of one width, root inside and tip outside, edge a at the left.
Labels come from the annotation file and are not trusted: the template escapes whatever enters the picture.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import cos, pi, radians, sin

from jinja2 import Environment, PackageLoader, StrictUndefined

from core.json_files import JsonObject

_MAPS = Environment(
    loader=PackageLoader("core.row"), autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
)
WIDTH, HEIGHT = 960, 470
CENTRE = (WIDTH / 2, 590.0)
ROOT, TIP = 250.0, 500.0
"""Radii of the ends of a cell, px."""
CELL_DEG = 14.0
"""Of a blade, at most: all together stay within `ARC_DEG`."""
ARC_DEG = 104.0
GAP_SHARE = 0.08
"""Of a cell, left free on each side."""
DARKEST = 0.7
"""Opacity of the colour of a blade all of whose surface two views see."""


@dataclass(frozen=True)
class _Text:
    x: float
    y: float
    text: str
    size: int = 12
    anchor: str = "middle"


@dataclass(frozen=True)
class _Cell:
    path: str
    opacity: float
    words: str


@dataclass(frozen=True)
class _Mark:
    x: float
    y: float
    hollow: bool
    """On the concave side, which is the back of what is drawn."""
    words: str


@dataclass(frozen=True)
class _Arc:
    """Cells side by side about the vertical."""

    count: int

    def at(self, cell: int, along: float, radius: float) -> tuple[float, float]:
        """Where a share of a cell from the left lies at a radius, px."""
        inside = GAP_SHARE + (1.0 - 2.0 * GAP_SHARE) * along
        angle = radians((cell + inside - self.count / 2) * min(CELL_DEG, ARC_DEG / self.count)) - pi / 2
        return round(CENTRE[0] + radius * cos(angle), 1), round(CENTRE[1] + radius * sin(angle), 1)

    def path(self, cell: int) -> str:
        """Outline of a cell."""
        (ax, ay), (bx, by) = self.at(cell, 0, ROOT), self.at(cell, 1, ROOT)
        (cx, cy), (dx, dy) = self.at(cell, 1, TIP), self.at(cell, 0, TIP)
        return f"M{ax} {ay}A{ROOT} {ROOT} 0 0 1 {bx} {by}L{cx} {cy}A{TIP} {TIP} 0 0 0 {dx} {dy}Z"


def row_map(row: JsonObject) -> str:
    """The map as a document of SVG.

    Args:
        row: the object of ``row.json``, with its findings.
    """
    if row["status"] == "unknown":
        words = f"The row of blades is unknown: {row['reason_text']}."
        return _drawn("The row of blades is unknown", texts=[_Text(WIDTH / 2, HEIGHT / 2, words, 16)])
    cell_of = {int(blade["number"]): int(blade["seen"]) - 1 for blade in row["blades"]}
    arc = _Arc(max(cell_of.values()) + 1)
    cells, texts = [], []
    for seen in row["coverage"]:
        number, two, five = int(seen["blade"]), float(seen["views_2"]), float(seen["views_5"])
        cell = cell_of[number]
        words = f"blade {number}: two views see {two:.0%} of its reconstructed surface, five {five:.0%}"
        cells.append(_Cell(arc.path(cell), round(DARKEST * two, 3), words))
        texts += [
            _Text(*arc.at(cell, 0.5, TIP + 16), str(number), 15),
            _Text(*arc.at(cell, 0.5, ROOT - 18), f"{two:.0%}"),
        ]
    marks = []
    for finding in row["findings"]:
        if finding["blade"] in cell_of:
            mark, name = _mark(arc, cell_of[finding["blade"]], finding)
            marks.append(mark)
            texts.append(_Text(mark.x + 10, mark.y + 4, name, anchor="start"))
    texts += [_Text(*arc.at(0, -0.06, radius), text, anchor="end") for radius, text in ((ROOT, "root"), (TIP, "tip"))]
    texts += [_Text(16, HEIGHT - 46 + 18 * k, line, 13, "start") for k, line in enumerate(_legend(row))]
    gaps = [arc.path(cell) for cell in range(arc.count) if cell not in cell_of.values()]
    return _drawn("The blades that were seen, their coverage and the findings on them", gaps, cells, marks, texts)


def _mark(arc: _Arc, cell: int, finding: JsonObject) -> tuple[_Mark, str]:
    along = 0.5 if finding["from_edge_a"] is None else float(finding["from_edge_a"])
    x, y = arc.at(cell, along, ROOT + float(finding["span"]) * (TIP - ROOT))
    side, name = str(finding["side"]).replace("_", " "), f"D{finding['defect']}"
    return _Mark(x, y, side == "concave", f"{name} {finding['label']}: {side}, span {finding['span']:.0%}"), name


def _legend(row: JsonObject) -> list[str]:
    low, high = row["count"]
    blades = f"{low}" if low == high else f"{low} to {high}"
    nowhere = sum(one["blade"] is None for one in row["findings"])
    edge = {"leading": "leading edge", "trailing": "trailing edge"}.get(row["edges"]["a"], "edge a")
    return [
        f"{len(row['blades'])} of {blades} blades seen, pitch {row['pitch_deg']:.3f} +- {row['pitch_sigma_deg']:.3f} "
        "degrees",
        "blue and below: share of the reconstructed surface that two views see at 60 degrees or less",
        f"marks: findings at their span; left {edge}; hollow: on the concave side"
        + (f"; on no blade: {nowhere}" if nowhere else ""),
    ]


def _drawn(
    title: str,
    gaps: Sequence[str] = (),
    cells: Sequence[_Cell] = (),
    marks: Sequence[_Mark] = (),
    texts: Iterable[_Text] = (),
) -> str:
    shapes = {"gaps": gaps, "cells": cells, "marks": marks, "texts": list(texts)}
    return _MAPS.get_template("row_map.svg").render(title=title, width=WIDTH, height=HEIGHT, **shapes)
