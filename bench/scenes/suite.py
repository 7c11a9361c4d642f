"""The scenes: a suite and a calibration family that were chosen, and inspections that chance drew.

Results on the chosen ones were looked at. The drawn ones are what they are by a seed, lenses, picture sizes, blades,
light, motion and detectors that nobody picked, so that a result on them says what the next unknown inspection gets.
"""

from __future__ import annotations

import math

import numpy as np

from bench.scenes.spec import Lens, Scene, Span

SIZES = ((480, 360), (480, 270), (448, 336), (400, 400), (384, 288), (352, 352), (320, 240))
WIDE, MIDDLE, NARROW = Lens(480, 360, 112.0, -0.04), Lens(480, 360, 92.0), Lens(480, 360, 68.0, 0.02)
SMALL = Lens(320, 240, 96.0)
SUITE: tuple[Scene, ...] = (
    Scene("easy", 11, MIDDLE, texture=1.3, glare=0.15, missed=0.3),
    Scene("wide", 12, WIDE),
    Scene("narrow", 13, NARROW, distance_mm=58.0),
    Scene("small", 14, SMALL),
    Scene("weak-texture", 15, MIDDLE, texture=0.45),
    Scene("glare", 16, MIDDLE, glare=1.4, texture=0.8),
    Scene("stall-and-back", 17, MIDDLE, stall=Span(35, 60), reverse_at=80),
    Scene("dark-gap", 18, MIDDLE, dark=Span(50, 62)),
    Scene("jump", 19, MIDDLE, jump_at=55, jump_deg=9.0),
    Scene("far-jump", 20, MIDDLE, jump_at=55, jump_deg=45.0, turn_deg=40.0),
    Scene("casing", 21, MIDDLE, casing=True),
    Scene("overlay", 22, MIDDLE, overlay=True, dark=Span(60, 66)),
    Scene("uneven-time", 23, MIDDLE, dropped=0.12, jitter_s=0.012),
    Scene("false-boxes", 24, WIDE, false_boxes=0.35, missed=0.55),
    Scene("masks", 25, NARROW, distance_mm=55.0, masks=True),
    Scene("noisy", 26, SMALL, noise=0.03, texture=0.8),
    Scene("still", 27, MIDDLE, n_frames=60, still=True, expect="flagged"),
    Scene("soft", 28, MIDDLE, n_frames=60, turn_deg=25.0, soft_mm=2.5, expect="flagged"),
    Scene("bare-metal", 29, MIDDLE, n_frames=60, turn_deg=25.0, texture=0.0, n_defects=5, expect="flagged"),
)
_LENS_A, _LENS_B, _LENS_C = Lens(440, 330, 84.0, 0.01), Lens(480, 352, 102.0, -0.02), Lens(360, 270, 76.0)
CALIBRATION: tuple[Scene, ...] = (
    Scene("fit-plain", 101, _LENS_A, false_boxes=0.15),
    Scene("fit-wide", 102, _LENS_B, false_boxes=0.3, missed=0.5),
    Scene("fit-weak", 103, _LENS_A, texture=0.4, false_boxes=0.2),
    Scene("fit-glare", 104, _LENS_B, glare=1.2, false_boxes=0.2),
    Scene("fit-small", 105, _LENS_C, false_boxes=0.25, noise=0.015),
    Scene("fit-gap", 106, _LENS_A, dark=Span(48, 56), false_boxes=0.2),
    Scene("fit-casing", 107, _LENS_C, casing=True, false_boxes=0.2),
    Scene("fit-noise", 108, _LENS_B, noise=0.035, texture=0.6, false_boxes=0.3, missed=0.6),
)


def drawn(name: str, seed: int) -> Scene:
    """A scene within what an inspection with one probe can be; every second one has one trouble more."""
    rng = np.random.default_rng(seed)
    width, height = SIZES[rng.integers(len(SIZES))]
    lens = Lens(width, height, round(rng.uniform(62.0, 118.0), 1), round(rng.uniform(-0.05, 0.03), 3))
    n_frames = int(rng.integers(80, 121))
    blades = int(rng.integers(48, 81))
    # As many blades as fit: fewer are broader.
    chord = 27.0 * 64 / blades * rng.uniform(0.9, 1.1)
    trouble = ("", "dark", "stall", "casing", "overlay", "")[rng.integers(6)] if rng.random() < 0.5 else ""
    start = int(rng.uniform(0.3, 0.6) * n_frames)
    span = Span(start, start + int(rng.integers(6, 14)))
    return Scene(
        name,
        seed,
        lens,
        n_frames=n_frames,
        fps=round(rng.uniform(8.0, 25.0), 2),
        blades_in_row=blades,
        chord_mm=(round(chord * 10 / 9, 2), round(chord * 8 / 9, 2)),
        texture=round(rng.uniform(0.45, 1.4), 2),
        glare=round(rng.uniform(0.1, 1.3), 2),
        turn_deg=round(n_frames * rng.uniform(0.33, 0.5), 1),
        # A narrow lens is held farther away.
        distance_mm=round(42.0 * math.sqrt(92.0 / lens.fov_deg) * rng.uniform(0.9, 1.15), 1),
        wobble_mm=round(rng.uniform(1.5, 3.0), 2),
        sweep_mm=round(rng.uniform(6.0, 10.0), 2),
        stall=span if trouble == "stall" else None,
        dark=span if trouble == "dark" else None,
        casing=trouble == "casing",
        overlay=trouble == "overlay",
        noise=round(rng.uniform(0.004, 0.02), 4),
        dropped=round(max(0.0, rng.uniform(-0.1, 0.1)), 3),
        jitter_s=round(max(0.0, rng.uniform(-0.01, 0.01)), 4),
        n_defects=int(rng.integers(5, 10)),
        missed=round(rng.uniform(0.2, 0.6), 2),
        false_boxes=round(max(0.0, rng.uniform(-0.2, 0.3)), 2),
        masks=bool(rng.random() < 0.3),
    )


DRAWN: tuple[Scene, ...] = tuple(drawn(f"drawn-{i}", 1000 + i) for i in range(1, 13))


FAMILIES = {"suite": SUITE, "calibration": CALIBRATION, "drawn": DRAWN}
