"""What rows are asked of: whole rows, too few blades, other shapes, and models that were put together wrongly."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from bench.scenes.blades import HEIGHT_MM, HUB_MM, pitch_rad
from bench.scenes.spec import Lens, Scene
from bench.scenes.suite import DRAWN, SUITE

F64 = NDArray[np.float64]

LENS = Lens(480, 360, 92.0)
FEW_TURN_DEG = 6.0
"""By which the rotor is turned beyond the blades that there are."""


class Expected(StrEnum):
    """What the row of a case should be."""

    ROW = "row"
    UNKNOWN = "unknown"


@dataclass(frozen=True)
class Weld:
    """How the second half of a model lies wrong: turned about the engine's axis, shifted along it, tilted."""

    turn_pitches: float = 0.0
    shift_mm: float = 0.0
    tilt_deg: float = 0.0

    def motion(self, scene: Scene) -> tuple[F64, F64]:
        """(3, 3) rotation and (3,) shift of points in the rotor's frame, mm; it is tilted about the blades in view."""
        turn = Rotation.from_rotvec([0.0, 0.0, self.turn_pitches * pitch_rad(scene)])
        middle = np.radians(scene.turn_deg) / 2
        out = np.array([np.cos(middle), np.sin(middle), 0.0])
        tilt = Rotation.from_rotvec(np.radians(self.tilt_deg) * out)
        center = (HUB_MM + HEIGHT_MM / 2) * out
        rotation = (tilt * turn).as_matrix()
        shift: F64 = center - tilt.apply(center) + np.array([0.0, 0.0, self.shift_mm])
        return rotation, shift


@dataclass(frozen=True)
class Case:
    """One scene, and how its model is wrong if it is."""

    scene: Scene
    expected: Expected = Expected.ROW
    weld: Weld | None = None

    @property
    def name(self) -> str:
        """Of its scene."""
        return self.scene.name


def _few(name: str, seed: int, blades: int, expected: Expected) -> Case:
    """A scene with so few blades, all of which pass the probe."""
    turn = FEW_TURN_DEG + 360.0 / 64 * max(blades - 1, 0)
    scene = Scene(name, seed, LENS, n_frames=60, turn_deg=turn, blades_present=blades, n_defects=2 * blades)
    return Case(scene, expected)


def _welded(name: str, weld: Weld) -> Case:
    return Case(Scene(name, 211, LENS, n_defects=6), Expected.UNKNOWN, weld)


SPECIAL: tuple[Case, ...] = (
    _few("hub", 201, 0, Expected.UNKNOWN),
    _few("one-blade", 202, 1, Expected.UNKNOWN),
    _few("two-blades", 203, 2, Expected.UNKNOWN),
    _few("three-blades", 204, 3, Expected.ROW),
    _few("four-blades", 205, 4, Expected.ROW),
    Case(Scene("less-stagger", 206, LENS, stagger_deg=(12.0, 30.0))),
    Case(Scene("more-stagger", 207, LENS, stagger_deg=(45.0, 60.0))),
    Case(Scene("shroud", 208, LENS, shroud=True)),
    Case(Scene("vanes", 209, LENS, casing=True)),
    Case(Scene("coarse-row", 210, LENS, blades_in_row=40, chord_mm=(46.0, 38.0), turn_deg=50.0)),
    _welded("welded-turned", Weld(turn_pitches=0.35)),
    _welded("welded-shifted", Weld(shift_mm=6.0)),
    _welded("welded-tilted", Weld(tilt_deg=8.0, shift_mm=1.5)),
    _welded("welded-a-blade-off", Weld(turn_pitches=-1.0)),
)


def halved(case: Case) -> Case:
    """With half of the pixels to a side: what is seen of a true surface hardly depends on them."""
    lens = replace(case.scene.lens, width=case.scene.lens.width // 2, height=case.scene.lens.height // 2)
    return replace(case, scene=replace(case.scene, lens=lens))


def _whole(scenes: Sequence[Scene]) -> tuple[Case, ...]:
    return tuple(Case(scene) for scene in scenes if scene.expect == "mapped")


FAMILIES: dict[str, tuple[Case, ...]] = {
    name: tuple(halved(case) for case in cases)
    for name, cases in (("special", SPECIAL), ("suite", _whole(SUITE)), ("drawn", _whole(DRAWN)))
}
