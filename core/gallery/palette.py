"""Colours of labels, the same in every picture."""

from __future__ import annotations

from collections.abc import Sequence

RGB = tuple[int, int, int]

PALETTE: tuple[RGB, ...] = (
    (255, 176, 0),
    (86, 180, 233),
    (240, 90, 160),
    (0, 200, 150),
    (190, 130, 255),
    (240, 228, 66),
    (255, 110, 60),
    (160, 220, 90),
)
"""Colours that stay apart on grey metal and for most kinds of colour blindness; labels take them in order."""


def label_colors(labels: Sequence[str]) -> dict[str, RGB]:
    """A colour for each label, by alphabet."""
    return {label: PALETTE[i % len(PALETTE)] for i, label in enumerate(sorted(set(labels)))}
