"""The five numbers of a row (two of its axis' direction, two of its place, the pitch) fitted to the surface."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from core.row.overlap import Hypothesis, contrast, partners
from core.row.sample import SurfaceSample

F64 = NDArray[np.float64]

EVALUATIONS = 120
"""Of the contrast, per seed."""
NEAR_TURNS, FAR_TURNS = (1, 2, 3), (1, 2, 3, 4, 5)
"""Pitches after which the surface is fitted to itself, all at once: radius and pitch trade in one alone.

First over few, which a pitch that is somewhat off does not lead astray; then over more, every distance counting alike.
On the true surface of the sample with 0.5 mm of smooth noise the pitch is 0.26 % off so, and 1.0 % with few alone that
count less the farther they are (root mean square of four draws)."""
KEPT_CONTRAST = 0.9
"""Of the contrast of few pitches: where more of them cost more, far blades lie wrong, as in a model that is bent."""
STEPS = {NEAR_TURNS: (30, 1e-3), FAR_TURNS: (40, 1e-5)}
"""Gauss-Newton steps at most, and the largest step that ends them before."""
NUDGE = 1e-5
FIRST_STEPS = (0.05, 0.05, 0.05, 0.05, 0.04)
"""Edges of the first simplex: rad, rad, shares of the radius, share of the pitch."""
LEAST_PARTNERS = 60


def best_contrast(sample: SurfaceSample, seed: Hypothesis) -> tuple[float, Hypothesis]:
    """The row of best contrast near a seed (Nelder and Mead 1965), and its contrast."""
    length = _radius(sample, seed)

    def loss(steps: F64) -> float:
        return -contrast(sample, _moved(seed, steps, length))

    simplex = np.vstack([np.zeros(5), np.diag(FIRST_STEPS)])
    found = minimize(
        loss, np.zeros(5), method="Nelder-Mead", options={"maxfev": EVALUATIONS, "initial_simplex": simplex}
    )
    return -float(found.fun), _moved(seed, found.x, length)


def refined(sample: SurfaceSample, row: Hypothesis, pitch_known: bool = False) -> Hypothesis:
    """A row fitted point to plane over several pitches at once, by Gauss-Newton steps with Cauchy weights.

    Args:
        sample: of the surface.
        row: to begin at.
        pitch_known: hold the pitch and fit the axis alone.
    """
    free = slice(0, 4 if pitch_known else 5)
    near = _fitted(sample, row, NEAR_TURNS, free)
    far = _fitted(sample, near, FAR_TURNS, free)
    return far if contrast(sample, far) >= KEPT_CONTRAST * contrast(sample, near) else near


def _fitted(sample: SurfaceSample, row: Hypothesis, turns: tuple[int, ...], free: slice) -> Hypothesis:
    """Fitted over turns by so many pitches; `free` are the numbers of the row that may change."""
    width = row.kernel(sample)
    most, least_step = STEPS[turns]
    for _ in range(most):
        length = _radius(sample, row)
        normal_matrix, right, count = np.zeros((5, 5)), np.zeros(5), 0
        for turn in turns:
            angle = turn * row.pitch_rad
            moved = row.axis.turned(sample.points, angle)
            found = partners(moved, sample.normals @ row.axis.matrix(angle).T, sample)
            use = np.flatnonzero(found.fits & (np.abs(found.across) < 4.0 * width))
            jacobian = _jacobian(sample, row, turn, use, found.rows[use], moved[use], length)
            weight = 1.0 / (1.0 + (found.across[use] / width) ** 2)
            if turns == NEAR_TURNS:
                weight /= turn * turn  # blades far off count once the near ones fit
            normal_matrix += (jacobian * weight[:, None]).T @ jacobian
            right += (jacobian * weight[:, None]).T @ found.across[use]
            count += len(use)
        if count < LEAST_PARTNERS:
            return row
        scale = np.diag(normal_matrix)
        damped = normal_matrix + np.diag(1e-6 * scale + 1e-12 * scale.max())
        steps = np.zeros(5)
        steps[free] = np.clip(-np.linalg.solve(damped[free, free], right[free]), -0.05, 0.05)
        row = _moved(row, steps, length)
        if np.abs(steps).max() < least_step:
            break
    return row


def _jacobian(
    sample: SurfaceSample,
    row: Hypothesis,
    turn: int,
    use: NDArray[np.int64],
    partner: NDArray[np.int64],
    moved: F64,
    length: float,
) -> F64:
    """(k, 5) change of the distances from the partners' planes, by small differences."""
    columns = []
    for k in range(5):
        steps = np.zeros(5)
        steps[k] = NUDGE
        other = _moved(row, steps, length)
        there = other.axis.turned(sample.points[use], turn * other.pitch_rad)
        columns.append(((there - moved) * sample.normals[partner]).sum(axis=1) / NUDGE)
    return np.stack(columns, axis=1)


def _moved(row: Hypothesis, steps: F64, length: float) -> Hypothesis:
    return Hypothesis(row.axis.moved(steps, length), row.pitch_rad * float(np.exp(steps[4])))


def _radius(sample: SurfaceSample, row: Hypothesis) -> float:
    return float(np.median(row.axis.cylinder(sample.points)[1]))
