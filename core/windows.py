"""Windows over the frame sequence (thesis 3.3.3): names, intervals, and how each case starts."""

from __future__ import annotations

from dataclasses import dataclass

from core.scene.case import CaseKind
from core.settings.groups import WindowSettings


@dataclass(frozen=True)
class Window:
    """One reconstruction case over the half-open frame interval [start, end)."""

    kind: CaseKind
    index: int
    start: int
    end: int
    warm_from: str = ""
    """Name of the case whose model this one starts from; empty = from scratch."""

    @property
    def name(self) -> str:
        """The thesis's name, e.g. ``seg_000_0000_0180``."""
        prefix = "seg" if self.kind == CaseKind.COARSE else self.kind
        return f"{prefix}_{self.index:03d}_{self.start:04d}_{self.end:04d}"


def coarse_windows(n_frames: int, settings: WindowSettings) -> list[Window]:
    """Coarse windows over `n_frames` search frames; truncated ones at the end stay while long enough.

    450 frames give the thesis's 22 cases. A clip shorter than the smallest window is one window. With warm
    starts, windows at multiples of `anchor_step` that are not contained in an earlier one map from
    scratch and the others start from the nearest such window before them.
    """
    if settings.mode == "single" or n_frames <= settings.coarse_min:
        return [Window(CaseKind.COARSE, 0, 0, n_frames)]
    windows: list[Window] = []
    anchor: Window | None = None
    for start in range(0, n_frames, settings.coarse_step):
        end = min(start + settings.coarse_length, n_frames)
        if end - start < settings.coarse_min:
            continue
        contained = anchor is not None and end <= anchor.end
        due = anchor is None or start - anchor.start >= settings.anchor_step
        warm = settings.start == "warm" and anchor is not None and (contained or not due)
        window = Window(CaseKind.COARSE, len(windows), start, end, anchor.name if warm and anchor else "")
        if not warm:
            anchor = window
        windows.append(window)
    return windows


def refined_windows(
    best: tuple[int, int], n_frames: int, settings: WindowSettings, warm_from: str = ""
) -> list[Window]:
    """Refined windows around the best coarse interval: full windows only.

    The interval is widened by the margin and clipped to the clip; a range shorter than one window is
    one window if it has `refine_min` frames. From 0120-0300 of 450 that is 13 windows.
    """
    if settings.mode == "single":
        return []
    low = max(0, best[0] - settings.refine_margin)
    high = min(n_frames, best[1] + settings.refine_margin)
    warm = warm_from if settings.start == "warm" else ""
    if high - low < settings.refine_length:
        return [Window(CaseKind.REFINE, 0, low, high, warm)] if high - low >= settings.refine_min else []
    starts = range(low, high - settings.refine_length + 1, settings.refine_step)
    return [Window(CaseKind.REFINE, i, start, start + settings.refine_length, warm) for i, start in enumerate(starts)]


def sequential_pairs(n_frames: int, window: int) -> list[tuple[int, int]]:
    """Each frame with its `window` followers: 2,235 pairs for 450 frames and window 5."""
    return [(i, j) for i in range(n_frames) for j in range(i + 1, min(i + window, n_frames - 1) + 1)]
