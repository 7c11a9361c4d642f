"""The row of a surface, or the reason why none is known."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.mapping.surface import Surface
from core.row.blades import Sheet, fit_sheet
from core.row.coverage import coverage_of, in_order, sightings
from core.row.fit import best_contrast, refined
from core.row.model import BladeRow, EdgeName, NoRow, RowStatus, UnknownRow
from core.row.overlap import Hypothesis, contrast, overlap, sides
from core.row.passing import leap_within, turn_of_camera
from core.row.regular import Differences, differences
from core.row.sample import FIT_POINTS, SurfaceSample, sample_surface, steadied, thinned
from core.row.section import section_of
from core.row.seeds import seeds
from core.scene.views import Views
from core.settings.row import RowSettings
from core.surface.ply import Mesh

F64 = NDArray[np.float64]

SEARCH_POINTS = 1500
MIN_CONTRAST = 0.15
"""True surfaces of one blade and of a hub have 0.00; a noisy draft surface seen from one side has 0.20."""
WORTH_FITTING = MIN_CONTRAST / 4
"""Contrast on the coarse points, which show less of it, that a hypothesis needs to be fitted to more of them."""
MIN_SHARE_KEPT = 0.5
"""Contrast over the mean overlap after one and two pitches: half of the overlap must vanish between blades."""
MIN_SECOND = 0.05
"""Least overlap after two pitches: with less there are two blades at most."""
SECOND_TO_TROUGH = 3.0
"""Overlap after two pitches, over that of the lower trough beside it."""
MIN_SIGMA_SHARE = 0.03
"""Of the pitch: radius and pitch trade, so what the blades agree on among themselves says too little.

On a draft surface of the sample, whose true pitch is 5.625 degrees, two draws of the points gave 5.83 and 5.95."""
LEAST_BLADES = 3
UNTOLD = RowSettings()
LEAST_VIEWS = 3
REPORTED_TURNS = (0.5, 1.0, 1.5, 2.0, 2.5, 3.0)
ENDS_PERCENT = (0.5, 99.5)
"""Of the radii on blades: root and tip."""


@dataclass(frozen=True)
class Apart:
    """The blades of a row, told apart."""

    sheet: Sheet
    contrast: float
    differences: Differences


def estimate_row(mesh: Mesh, views: Views, seed: int, told: RowSettings = UNTOLD) -> BladeRow | NoRow:
    """The row of equal blades that a mesh shows: `search_row`, then `describe_row`."""
    steady = steadied(mesh, seed)
    found = _searched(steady, views, seed)
    return found if isinstance(found, NoRow) else _of_found(mesh, steady, views, seed, found, told)


def search_row(mesh: Mesh, views: Views, seed: int) -> Hypothesis | NoRow:
    """Axis and pitch of the row that a mesh shows best; whether it is a row at all `describe_row` says.

    Args:
        mesh: oriented towards the cameras (`core.mapping.facing.oriented`).
        views: the model's, in order of time.
        seed: of the points drawn.
    """
    return _searched(steadied(mesh, seed), views, seed)


def _searched(steady: Mesh, views: Views, seed: int) -> Hypothesis | NoRow:
    drawn = sample_surface(steady, seed)
    if not len(drawn):
        return NoRow(UnknownRow.NO_SURFACE)
    if len(views) < LEAST_VIEWS:
        return NoRow(UnknownRow.TOO_FEW_VIEWS)
    fine = thinned(drawn, FIT_POINTS)
    found = find_row(thinned(drawn, SEARCH_POINTS), fine, views.R, views.t)
    if found is None:
        return NoRow(UnknownRow.NO_REPETITION)
    return Hypothesis(found.axis.nearest_to(fine.points.mean(axis=0)), found.pitch_rad)


def describe_row(
    mesh: Mesh, views: Views, seed: int, found: Hypothesis, told: RowSettings = UNTOLD
) -> BladeRow | NoRow:
    """Blades, root and tip and coverage of the row that `search_row` found in the same mesh, or why it is none.

    Args:
        mesh: as searched.
        views: as searched.
        seed: of the points drawn.
        found: axis and pitch.
        told: what the user knows; with the number of blades the pitch is exact, and the axis is fitted to it.
    """
    return _of_found(mesh, steadied(mesh, seed), views, seed, found, told)


def _of_found(
    mesh: Mesh, steady: Mesh, views: Views, seed: int, found: Hypothesis, told: RowSettings
) -> BladeRow | NoRow:
    """`describe_row`: all but root, tip and coverage is of the smooth surface, whose borders are drawn in."""
    smooth = thinned(sample_surface(steady, seed), FIT_POINTS)
    drawn = sample_surface(mesh, seed, normals_of=steady)
    fine = thinned(drawn, FIT_POINTS)
    # Coverage is a share of the area: a thinned sample has too many points where the surface bends, as at the edges.
    even = drawn.of(np.arange(0, len(drawn), max(1, len(drawn) // SEARCH_POINTS)))
    if told.count is not None:
        found = refined(smooth, Hypothesis(found.axis, 2 * np.pi / told.count), pitch_known=True)
        found = Hypothesis(found.axis.nearest_to(smooth.points.mean(axis=0)), found.pitch_rad)
    apart = told_apart(smooth, found)
    if isinstance(apart, NoRow):
        return apart
    return _described(fine, smooth, even, apart, views, Surface(mesh.vertices, mesh.faces), told)


def without_leap(
    row: BladeRow, views: Views, moments_s: Mapping[int, float], jumps: Sequence[tuple[int, int]] = ()
) -> BladeRow | NoRow:
    """The row, or that it is none: a part of the model was joined whole pitches off, which its surface cannot show.

    Args:
        row: of the model.
        views: the model's, in order of time.
        moments_s: of the frames, s.
        jumps: neighbouring frames between which the pictures jump: there the turn may leap.
    """
    turn = turn_of_camera(row.axis, row.pitch_rad, views.centers)
    leap = leap_within(dict(zip(views.frame_index.tolist(), turn.tolist(), strict=True)), moments_s, jumps)
    return row if leap is None else NoRow(UnknownRow.TURN_LEAPS, row.contrast, leap=leap)


def find_row(coarse: SurfaceSample, fine: SurfaceSample, rotations: F64, translations: F64) -> Hypothesis | None:
    """The row of best contrast on the fine sample; None where no motion between views looks like a turn."""
    found = []
    for first in seeds(coarse, rotations, translations):
        value, row = best_contrast(coarse, first)
        if value < WORTH_FITTING:
            continue
        row = refined(fine, row)
        found.append((contrast(fine, row), row))
    return max(found, key=lambda item: item[0])[1] if found else None


def told_apart(fine: SurfaceSample, row: Hypothesis) -> Apart | NoRow:
    """The blades of a hypothesis, or why it is no row."""
    value = contrast(fine, row)
    if value < MIN_CONTRAST:
        return NoRow(UnknownRow.NO_REPETITION, value)
    one, trough, second, after = overlap(
        sides(fine, row.axis), row.axis, [k * row.pitch_rad for k in (1.0, 1.5, 2.0, 2.5)], row.kernel(fine)
    )
    if value < MIN_SHARE_KEPT * float(one + second) / 2:
        return NoRow(UnknownRow.NO_REPETITION, value)
    sheet = fit_sheet(fine, row)
    found = differences(sheet, fine)
    if len(found.blades) < LEAST_BLADES:
        return NoRow(UnknownRow.TOO_FEW_BLADES, value)
    worst = found.worst
    if worst is not None and worst.over > 1:
        return NoRow(UnknownRow.PITCH_NOT_CONSTANT, value, worst)
    # After that: blades half a pitch off fill the troughs.
    if second < max(MIN_SECOND, SECOND_TO_TROUGH * min(trough, after)):
        return NoRow(UnknownRow.TOO_FEW_BLADES, value)
    return Apart(sheet, value, found)


def _described(
    fine: SurfaceSample,
    smooth: SurfaceSample,
    even: SurfaceSample,
    apart: Apart,
    views: Views,
    surface: Surface,
    told: RowSettings,
) -> BladeRow:
    sheet, blades = apart.sheet, apart.differences.blades
    axis, pitch = sheet.axis, sheet.pitch_rad
    on_blade = sides(even, axis)
    seen, index = sightings(on_blade, views, surface), sheet.blade(on_blade.points)
    count = told.count
    first = in_order(seen, index, blades)
    numbers = told_numbers(first, told)
    spread = apart.differences.steps
    sigma = pitch * max(MIN_SIGMA_SHARE, float(spread.std()) / np.sqrt(len(spread))) if count is None else 0.0
    _, radius, _ = axis.cylinder(sides(fine, axis).points)
    root, tip = np.percentile(radius, ENDS_PERCENT)
    kernel = Hypothesis(axis, pitch).kernel(fine)
    shares = overlap(sides(fine, axis), axis, [k * pitch for k in REPORTED_TURNS], kernel)
    fewest = int(np.ceil(2 * np.pi / (pitch + 2 * sigma) - 1e-6))
    most = int(np.floor(2 * np.pi / (pitch - 2 * sigma) + 1e-6))
    return BladeRow(
        RowStatus.ESTIMATED if count is None else RowStatus.USER,
        sheet,
        sigma,
        (fewest, most),
        apart.contrast,
        {f"{turn:g}": round(float(share), 4) for turn, share in zip(REPORTED_TURNS, shares, strict=True)},
        float(root),
        float(tip),
        fine.spacing,
        numbers,
        section_of(sheet, smooth),
        coverage_of(seen, index, numbers),
        first[int(blades.min())] == 1,
        EdgeName.UNKNOWN if told.edge_a is None else EdgeName(told.edge_a),
        told.zero_blade,
        told.direction if told.zero_blade is not None or told.direction == "reversed" else None,
    )


def told_numbers(seen: dict[int, int], told: RowSettings) -> dict[int, int]:
    """Numbers of the blades by index: in order of first appearance (`seen`, from 1), or as the user counts.

    With a zero blade, which has the engine's number 1, they go round from the last to the first.
    """
    way = 1 if told.direction == "as_seen" else -1
    if told.zero_blade is not None and told.count is not None:
        return {index: way * (number - told.zero_blade) % told.count + 1 for index, number in seen.items()}
    last = max(seen.values())
    return seen if way > 0 else {index: last + 1 - number for index, number in seen.items()}
