"""The suite that results are reported on, and the family that confidence is fitted on; they share no seed and no lens.

Chosen for what makes inspections hard, before any of them was run.
"""

from __future__ import annotations

from bench.scenes.drawn import DRAWN
from bench.scenes.spec import Lens, Scene, Span

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

FAMILIES = {"suite": SUITE, "calibration": CALIBRATION, "drawn": DRAWN}
