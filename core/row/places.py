"""Where on the row a place lies: its blade, and how far from root to tip."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass

import numpy as np

from core.json_files import JsonObject
from core.row.blades import radial
from core.row.model import BladeRow, Side

END_SIGMAS = 3.0
"""A place that faces the axis, or away from it, is of the platform or the tip within so many sigmas of that radius."""


@dataclass(frozen=True)
class OnRow:
    """Where on a row a place lies; None = unknown."""

    blade: int | None
    """Number of the blade; None between the blades, or on one that hardly was seen."""
    side: Side
    span: float
    """0 at the root, 1 at the tip, of what was seen."""
    span_sigma: float
    root_distance: float
    """Along the radius, in the unit of the model."""
    root_distance_sigma: float

    def to_dict(self) -> JsonObject:
        """JSON form; numbers with six digits."""
        values = asdict(self)
        return {name: round(value, 6) if isinstance(value, float) else value for name, value in values.items()}


def on_row(row: BladeRow, place: Sequence[float], normal: Sequence[float] | None, sigma: float | None) -> OnRow:
    """Where on the row a place lies.

    Args:
        row: of the model that the place is of.
        place: (3,) in the model's world frame.
        normal: (3,) unit, of the surface there; None = unknown.
        sigma: of the place, in the unit of the model; None = unknown, and counted as zero.
    """
    point = np.asarray(place, np.float64)[None]
    _, radius, _ = row.axis.cylinder(point)
    height = row.tip_radius - row.root_radius
    distance = float(radius[0]) - row.root_radius
    own = float(np.hypot(row.radius_sigma, sigma or 0.0))
    side = Side.UNKNOWN
    blade = row.numbers.get(int(row.sheet.blade(point)[0]))
    if normal is not None and bool(radial(row.axis, point, np.asarray(normal, np.float64)[None])[0]):
        side = Side.OTHER
        if abs(distance) < END_SIGMAS * own:
            side = Side.PLATFORM
        elif abs(distance - height) < END_SIGMAS * own:
            side = Side.TIP
        if side != Side.TIP:
            blade = None
    share = float(np.clip(distance / height, 0.0, 1.0))
    return OnRow(blade, side, share, float(np.hypot(own, share * row.radius_sigma) / height), distance, own)
