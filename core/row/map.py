"""``row_map.svg``: the arc of the blades that were seen, with their coverage and the findings on them.

It is a scheme, not a projection: every blade has a cell of one width, root inside and tip outside, edge a at the left.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import cos, pi, radians, sin
from typing import Any
from xml.sax.saxutils import escape

from core.json_files import JsonObject

WIDTH, HEIGHT = 960.0, 470.0
CENTRE = (WIDTH / 2, 590.0)
ROOT, TIP = 250.0, 500.0
"""Radii of the ends of a cell, px."""
CELL_DEG = 14.0
"""Of a blade, at most: all together stay within `ARC_DEG`."""
ARC_DEG = 104.0
GAP_SHARE = 0.08
"""Of a cell, left free on each side."""
MARK = 7.0
"""Radius of the mark of a finding, px."""
_SEEN, _GROUND, _INK = "#2f6fb0", "#eef1f4", "#1b2733"
_HOLLOW = ("concave",)
"""Sides whose findings are drawn hollow: they lie on the back of what is drawn."""


@dataclass(frozen=True)
class _Arc:
    """Cells side by side about the vertical."""

    count: int

    @property
    def cell_deg(self) -> float:
        return min(CELL_DEG, ARC_DEG / max(self.count, 1))

    def at(self, cell: int, along: float, radius: float) -> tuple[float, float]:
        """Where a share of a cell from the left lies at a radius, px."""
        inside = GAP_SHARE + (1.0 - 2.0 * GAP_SHARE) * along
        angle = radians((cell + inside - self.count / 2) * self.cell_deg) - pi / 2
        return CENTRE[0] + radius * cos(angle), CENTRE[1] + radius * sin(angle)


def row_map(row: JsonObject) -> str:
    """The map as a document of SVG.

    Args:
        row: the object of ``row.json``, with its findings.
    """
    if row["status"] == "unknown":
        body = _text(WIDTH / 2, HEIGHT / 2, f"The row of blades is unknown: {row['reason_text']}.", 16, "middle")
        return _document(body, "The row of blades is unknown")
    cells = {int(blade["number"]): int(blade["seen"]) - 1 for blade in row["blades"]}
    arc, coverage = _Arc(max(cells.values()) + 1), {int(one["blade"]): one for one in row["coverage"]}
    parts = [_ring(arc, cell, ROOT, TIP, "none", dashed=True) for cell in set(range(arc.count)) - set(cells.values())]
    parts += [_cell(arc, cell, number, coverage[number]) for number, cell in cells.items()]
    parts += _marks(arc, cells, row["findings"])
    parts += _legend(row)
    parts.append(_text(*arc.at(0, -0.06, ROOT - 4), "root", 12, "end"))
    parts.append(_text(*arc.at(0, -0.06, TIP), "tip", 12, "end"))
    return _document("".join(parts), "The blades that were seen, their coverage and the findings on them")


def _cell(arc: _Arc, cell: int, number: int, seen: Mapping[str, Any]) -> str:
    """A blade: its number, and as much of it filled, from the root on, as two views see of its surface."""
    share = float(seen["views_2"])
    title = f"blade {number}: two views see {100 * share:.0f} % of its reconstructed surface, five {_percent(seen)}"
    x, y = arc.at(cell, 0.5, TIP + 16)
    return (
        f"<g><title>{title}</title>{_ring(arc, cell, ROOT, TIP, _GROUND)}"
        f"{_ring(arc, cell, ROOT, ROOT + share * (TIP - ROOT), _SEEN, 0.45)}"
        f"{_text(x, y, str(number), 15, 'middle')}"
        f"{_text(*arc.at(cell, 0.5, ROOT - 18), f'{100 * share:.0f} %', 11, 'middle')}</g>"
    )


def _percent(seen: Mapping[str, Any]) -> str:
    return f"{100 * float(seen['views_5']):.0f} %"


def _ring(arc: _Arc, cell: int, low: float, high: float, fill: str, opacity: float = 1.0, dashed: bool = False) -> str:
    corners = [arc.at(cell, along, radius) for along, radius in ((0, low), (1, low), (1, high), (0, high))]
    (ax, ay), (bx, by), (cx, cy), (dx, dy) = corners
    path = (
        f"M{ax:.1f} {ay:.1f}A{low:.1f} {low:.1f} 0 0 1 {bx:.1f} {by:.1f}L{cx:.1f} {cy:.1f}"
        f"A{high:.1f} {high:.1f} 0 0 0 {dx:.1f} {dy:.1f}Z"
    )
    line = ' stroke-dasharray="4 4"' if dashed else ""
    return f'<path d="{path}" fill="{fill}" fill-opacity="{opacity:g}" stroke="{_INK}" stroke-width="0.8"{line}/>'


def _marks(arc: _Arc, cells: Mapping[int, int], findings: Sequence[JsonObject]) -> list[str]:
    parts: list[str] = []
    for one in findings:
        if one["blade"] not in cells:
            continue
        along = 0.5 if one["from_edge_a"] is None else float(one["from_edge_a"])
        x, y = arc.at(cells[one["blade"]], along, ROOT + float(one["span"]) * (TIP - ROOT))
        fill = "white" if one["side"] in _HOLLOW else "#c62828"
        name = f"D{one['defect']}"
        words = f"{name} {one['label']}: {str(one['side']).replace('_', ' ')}, span {100 * one['span']:.0f} %"
        parts.append(
            f'<g><title>{escape(words)}</title><circle cx="{x:.1f}" cy="{y:.1f}" r="{MARK:g}" fill="{fill}" '
            f'stroke="#c62828" stroke-width="2"/>{_text(x + MARK + 3, y + 4, name, 12, "start")}</g>'
        )
    return parts


def _legend(row: JsonObject) -> list[str]:
    low, high = row["count"]
    blades = f"{low}" if low == high else f"{low} to {high}"
    nowhere = sum(one["blade"] is None for one in row["findings"])
    edge = {"leading": "leading edge", "trailing": "trailing edge"}.get(row["edges"]["a"], "edge a")
    lines = [
        f"{len(row['blades'])} of {blades} blades seen, pitch {row['pitch_deg']:.3f} +- {row['pitch_sigma_deg']:.3f}"
        " degrees",
        "blue: share of the reconstructed surface of the blade that at least two views see at 60 degrees or less",
        f"marks: findings at their span; left {edge}; hollow: on the concave side"
        + (f"; on no blade: {nowhere}" if nowhere else ""),
    ]
    return [_text(16, HEIGHT - 46 + 18 * k, line, 13, "start") for k, line in enumerate(lines)]


def _text(x: float, y: float, text: str, size: float, anchor: str) -> str:
    return (
        f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size:g}" text-anchor="{anchor}" fill="{_INK}">{escape(text)}</text>'
    )


def _document(body: str, title: str) -> str:
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH:g} {HEIGHT:g}" role="img" '
        f'font-family="system-ui, sans-serif"><title>{title}</title>'
        f'<rect width="{WIDTH:g}" height="{HEIGHT:g}" fill="white"/>{body}</svg>\n'
    )
