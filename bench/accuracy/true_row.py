"""The true row of blades of a rendered clip: on which blade a point lies, and how far from root to tip."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

USUAL_STAGGER_DEG = (28.0, 50.0)
"""At root and tip, of truths that do not tell it."""
BODY = 0.12
"""The middle of a blade's section lies this share of the chord off the line between its edges."""


@dataclass(frozen=True)
class TrueFinding:
    """Where on the row a defect is."""

    blade: int
    side: int
    """1 = convex, -1 = concave."""
    chord: float
    """0 = leading edge, 1 = trailing edge."""


@dataclass(frozen=True)
class TrueRow:
    """A row of equal blades about the z axis; lengths in mm."""

    pitch_rad: float
    root_mm: float
    tip_mm: float
    chord_mm: tuple[float, float]
    """At root and tip."""
    stagger_deg: tuple[float, float]
    findings: Mapping[int, TrueFinding]
    """By the number of the defect."""
    way: int = 1
    """-1 where the leading edge is the one at larger z, which turns every section half round."""

    def span(self, points: F64) -> F64:
        """(n,) 0 at the root, 1 at the tip; beyond both outside of the blades."""
        span: F64 = (np.hypot(points[:, 0], points[:, 1]) - self.root_mm) / (self.tip_mm - self.root_mm)
        return span

    def edge_distances(self, finding: TrueFinding, span: float) -> tuple[float, float]:
        """Along the chord from a finding at a share of the span to the leading and to the trailing edge, mm."""
        chord = float(self._chord(np.array(span)))
        return finding.chord * chord, (1.0 - finding.chord) * chord

    def _chord(self, span: F64) -> F64:
        """Length of the chord at shares of the span, mm."""
        root, tip = self.chord_mm
        chord: F64 = root + (tip - root) * span
        return chord

    def blade(self, points: F64) -> I64:
        """(n,) the blade whose section is nearest, by the place across its chord."""
        span = self.span(points)
        angle, radius = np.arctan2(points[:, 1], points[:, 0]), np.hypot(points[:, 0], points[:, 1])
        stagger = np.radians(self.stagger_deg[0] + (self.stagger_deg[1] - self.stagger_deg[0]) * span)
        chord = self._chord(span)
        # Of the point at this height on the middle of a section that is staggered so.
        tangential = (self.way * BODY * chord + points[:, 2] * np.sin(stagger)) / np.cos(stagger)
        blade: I64 = np.round((angle - tangential / radius) / self.pitch_rad).astype(np.int64)
        return blade


def true_row(defects: Mapping[str, Any], mm_per_unit: float) -> TrueRow | None:
    """From `defects.json`; None where it tells nothing of a row."""
    if "blades_in_row" not in defects:
        return None
    root, height = (float(defects[name]) * mm_per_unit for name in ("hub_radius_m", "blade_height_m"))
    chord, stagger = defects["chord_m"], defects.get("stagger_deg", USUAL_STAGGER_DEG)
    row = TrueRow(
        pitch_rad=2.0 * np.pi / int(defects["blades_in_row"]),
        root_mm=root,
        tip_mm=root + height,
        chord_mm=(float(chord[0]) * mm_per_unit, float(chord[1]) * mm_per_unit),
        stagger_deg=(float(stagger[0]), float(stagger[1])),
        findings={
            int(one["id"]): TrueFinding(int(one["blade"]), int(one["side"]), float(one["chord"]))
            for one in defects["defects"]
        },
    )
    # The nominal places lie on the blades that they are said to be on, one way or the other.
    centers = np.array([one["center"] for one in defects["defects"]], np.float64).reshape(-1, 3) * mm_per_unit
    blades = np.array([one.blade for one in row.findings.values()], np.int64)
    ways = (row, replace(row, way=-1))
    return max(ways, key=lambda one: int((one.blade(centers) == blades).sum()))
