"""Inspections that chance drew: lenses, picture sizes, blades, light, motion and detectors that nobody picked.

The suite and the calibration family were chosen and their results were looked at. These are what they are by a seed, so
that a result on them says what the next unknown inspection gets.
"""

from __future__ import annotations

import math

import numpy as np

from bench.scenes.spec import Lens, Scene, Span

SIZES = ((480, 360), (480, 270), (448, 336), (400, 400), (384, 288), (352, 352), (320, 240))


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
