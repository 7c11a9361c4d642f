"""The winner mapped again: the search's tuned bundle adjustment and warm starts may inherit errors."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Literal

from core.checks.stats import ModelStats, model_stats
from core.sparse.cases import Case, run_case
from core.sparse.mapper import Progress

if TYPE_CHECKING:
    import pycolmap

CONFIRM_TRACKS = 1000
"""Keypoints per image that take part when the search takes all; on these COLMAP's own settings are affordable."""

CLEARLY_WEAKER = 0.97
"""The searched model is kept only if the confirmed one has a smaller share of its images or points than this."""

Kept = Literal["confirmed", "searched"]


def confirm(case: Case, progress: Progress | None = None) -> pycolmap.Reconstruction | None:
    """Map the window from scratch with COLMAP's bundle adjustment; None when that gives no model."""
    settings = case.settings.model_copy(
        update={
            "bundle_adjustment": "colmap",
            "search_tracks": case.settings.search_tracks or CONFIRM_TRACKS,
        }
    )
    return run_case(replace(case, settings=settings), None, progress).model


def choose(searched: ModelStats, confirmed: ModelStats | None) -> Kept:
    """The confirmed model, unless it is clearly weaker than the searched one."""
    if confirmed is None:
        return "searched"
    weaker = (
        confirmed.registered_images < CLEARLY_WEAKER * searched.registered_images
        or confirmed.points3D < CLEARLY_WEAKER * searched.points3D
    )
    return "searched" if weaker else "confirmed"


def confirmed_or_searched(
    case: Case,
    searched: pycolmap.Reconstruction,
    progress: Progress | None = None,
    is_wrong: Callable[[pycolmap.Reconstruction], bool] | None = None,
) -> tuple[pycolmap.Reconstruction, Kept]:
    """The model to go on with and which one it is; a confirmed model that `is_wrong` vetoes is not gone on with."""
    confirmed = confirm(case, progress)
    if confirmed is None or choose(model_stats(searched), model_stats(confirmed)) == "searched":
        return searched, "searched"
    if is_wrong is not None and is_wrong(confirmed):
        return searched, "searched"
    return confirmed, "confirmed"
