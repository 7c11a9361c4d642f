"""A model whose blades are not equally far apart is no row, and is flagged; one whose blades are is neither."""

from __future__ import annotations

from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from core.flags import Severity
from core.row.blades import fit_sheet
from core.row.estimate import Apart, told_apart
from core.row.files import read_blades, write_blades
from core.row.fit import refined
from core.row.model import NoRow, UnknownRow
from core.row.overlap import Hypothesis
from core.row.regular import END_OFF_PITCHES, ENDS_OF, MAX_OFF_PITCHES, Differences, differences
from core.row.sample import SurfaceSample, sample_surface, thinned
from core.row.turn import Axis
from core.surface.ply import Mesh
from tests.core.making_blades import PITCH_RAD, blades, turned

F64 = NDArray[np.float64]

TRUE = Hypothesis(Axis(np.array([0.0, 0.0, 1.0]), np.zeros(3)), PITCH_RAD)
POINTS = 1500
LEFT, RIGHT = 3, 6
"""Blades of the first group, and of both."""


def welded(pitches: float = 0.0, along: float = 0.0, tilt_deg: float = 0.0, shared: int = 0) -> Mesh:
    """Two groups of three blades, mm, the second moved as by a model that was joined wrongly.

    Args:
        pitches: that it is turned about the axis of the row.
        along: shift along the axis.
        tilt_deg: turn about its radius.
        shared: blades of the first group that the second shows too, so that the surface is there twice.
    """
    first, second = blades(LEFT), blades(RIGHT, skipped=tuple(range(LEFT - shared)))
    middle = second.vertices.mean(axis=0)
    radius = middle * (1.0, 1.0, 0.0) / np.hypot(*middle[:2])
    tilted = Rotation.from_rotvec(np.radians(tilt_deg) * radius).apply(second.vertices - middle) + middle
    moved = turned(tilted, pitches * PITCH_RAD) + np.array([0.0, 0.0, along])
    faces = np.concatenate([first.faces, second.faces + len(first.vertices)])
    return Mesh(np.concatenate([first.vertices, moved]), faces.astype(np.int32))


def wavy(mesh: Mesh, height: float, length: float) -> Mesh:
    """The same with smooth random waves on it, as a reconstructed surface has them."""
    rng = np.random.default_rng(0)
    waves = [(rng.normal(size=3) / length, rng.uniform(0.0, 2 * np.pi), rng.normal(size=3)) for _ in range(40)]
    off = np.sum([np.cos(mesh.vertices @ wave + phase)[:, None] * way for wave, phase, way in waves], axis=0)
    return Mesh(mesh.vertices + off * height / np.sqrt((off**2).mean()), mesh.faces)


def points(mesh: Mesh) -> SurfaceSample:
    return thinned(sample_surface(mesh, 0), POINTS)


def fitted(sample: SurfaceSample) -> Hypothesis:
    """The row that fits best near the true one, as the search ends with it."""
    return refined(sample, TRUE)


@pytest.mark.parametrize(
    "mesh",
    [
        welded(pitches=-0.4),
        welded(pitches=0.4, shared=2),
        welded(along=5.0),
        welded(tilt_deg=6.0),
    ],
    ids=["turned", "twice there", "along", "tilted"],
)
def test_a_wrongly_welded_model_is_no_row_and_is_flagged(mesh: Mesh) -> None:
    sample = points(mesh)
    found = told_apart(sample, fitted(sample))
    assert isinstance(found, NoRow)
    assert found.reason == UnknownRow.PITCH_NOT_CONSTANT
    (flag,) = found.flags
    assert (flag.code, flag.severity, flag.threshold) == ("row_irregular", Severity.WARNING, MAX_OFF_PITCHES)
    assert flag.value is not None
    assert flag.value > MAX_OFF_PITCHES
    assert found.irregular is not None
    one, other = found.irregular.blades
    assert one <= LEFT < other, "one of each group"


@pytest.mark.parametrize("mesh", [welded(), wavy(welded(), 0.3, 5.0)], ids=["true", "wavy"])
def test_a_right_model_is_a_row_without_a_flag(mesh: Mesh) -> None:
    sample = points(mesh)
    found = told_apart(sample, fitted(sample))
    assert isinstance(found, Apart)
    assert np.abs(found.differences.steps).max() < 0.02


def test_one_pair_alone_does_not_make_a_model_irregular() -> None:
    """A blade that lies wrong does so beside all others; two half-seen ones may seem to beside each other alone."""
    right, wrong = np.full(5, 0.001), np.full(5, 0.3)
    of_pair = {(0, 1): right, (1, 2): right, (0, 2): wrong}
    alone = Differences(np.arange(3), of_pair).worst
    assert alone is not None
    assert alone.off_pitches == pytest.approx(0.001)
    twice = Differences(np.arange(3), {**of_pair, (1, 2): wrong}).worst
    assert twice is not None
    assert twice.off_pitches == pytest.approx(0.3)
    assert twice.blades[1] == 3
    only = Differences(np.arange(2), {(0, 1): wrong}).worst
    assert only is not None
    assert only.off_pitches == pytest.approx(0.3)


def test_a_third_of_the_pairs_of_a_blade_may_lie_worse() -> None:
    """The ends of eleven blades, half seen from either way, share little; a part joined wrongly lies so beside half."""
    near, far = np.full(5, 0.01), np.full(5, 0.2)
    pairs = list(combinations(range(11), 2))
    ends = Differences(np.arange(11), {(a, b): far if b - a > 7 else near for a, b in pairs}).worst
    assert ends is not None
    assert ends.off_pitches == pytest.approx(0.01)
    joined = Differences(np.arange(11), {(a, b): far if a < 8 <= b else near for a, b in pairs}).worst
    assert joined is not None
    assert joined.off_pitches == pytest.approx(0.2)


def one_blade_off(count: int, blade: int, off: float) -> Differences:
    """Blades that lie on each other, but for one that lies beside all others."""
    pairs = combinations(range(count), 2)
    return Differences(np.arange(count), {pair: np.full(5, off if blade in pair else 0.005) for pair in pairs})


@pytest.mark.parametrize(
    ("count", "blade", "off", "irregular"),
    [
        (6, 5, 0.1, False),
        (6, 0, 0.1, False),
        (6, 5, 0.2, True),
        (6, 3, 0.1, True),
        (5, 4, 0.1, True),
    ],
    ids=["last", "first", "last and far off", "not an end", "an end of few"],
)
def test_a_blade_at_the_end_of_the_view_may_lie_off_by_more(
    count: int, blade: int, off: float, irregular: bool
) -> None:
    worst = one_blade_off(count, blade, off).worst
    assert worst is not None
    assert blade + 1 in worst.blades
    assert (worst.over > 1) == irregular
    (flag,) = NoRow(UnknownRow.PITCH_NOT_CONSTANT, 0.4, worst).flags
    assert flag.threshold == (END_OFF_PITCHES if count >= ENDS_OF and blade in (0, count - 1) else MAX_OFF_PITCHES)


def test_the_worst_pair_tells_by_how_much(tmp_path: Path) -> None:
    sample = points(welded(pitches=0.3))
    found = differences(fit_sheet(sample, TRUE), sample)
    assert found.steps.tolist() == pytest.approx([0.0, 0.0, 0.3, 0.0, 0.0], abs=0.02)
    pair = found.worst
    assert pair is not None
    assert pair.off_pitches == pytest.approx(0.3, abs=0.02)
    assert "blades 1 and" in pair.where or "blades 2 and" in pair.where or "blades 3 and" in pair.where
    row = NoRow(UnknownRow.PITCH_NOT_CONSTANT, 0.4, pair)
    write_blades(tmp_path, row)
    assert read_blades(tmp_path) == row
    assert row.to_dict()["evidence"] == {"contrast": 0.4, "off_pitches": round(pair.off_pitches, 4)}
    assert NoRow(UnknownRow.NO_REPETITION).flags == []
