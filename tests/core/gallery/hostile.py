"""A gallery page of labels that try to leave their place."""

from __future__ import annotations

from dataclasses import replace

from core.gallery.boxes import FrameBoxes
from core.gallery.defects import BestFrame, DefectLine, Instant
from core.gallery.evidence import Evidence
from core.gallery.page import gallery_page
from core.gallery.palette import label_colors
from core.scene.frame import SourceFrame
from tests.core.making_rows import mapped, unplaced

NASTY = [
    "<script>alert(1)</script>",
    '"><img src=x onerror=alert(1)>',
    "' onmouseover='alert(1)",
    "</style></script><svg/onload=alert(1)>",
    "javascript:alert(1)//&quot;",
    "{{ 7 * 7 }}{% raw %}",
    "läbel ☃ \u202e",
]


def hostile_page() -> str:
    """Every part of the page, once: defects with and without a frame, evidence, all outcomes, a frame left out."""
    rows = [replace(mapped(n, (n, 0, 0), float(n), label), defect_id=n) for n, label in enumerate(NASTY)]
    rows += [unplaced(20, "no_frame", source_index=None), unplaced(21, score=None, label=NASTY[0])]
    frames = [FrameBoxes(SourceFrame(0, n), float(n), (row, rows[-1])) for n, row in enumerate(rows[:5])]
    lines = [
        DefectLine(
            number=n,
            label=label,
            model=0,
            size=0.5 if n else None,
            size_sigma=0.0625 if n > 1 else None,
            unit="model",
            start=Instant(0, float(n)) if n else None,
            end=Instant(0, n + 0.5) if n else None,
            visits=n,
            n_detections=n + 1,
            n_frames=n + 1,
            n_could_show=n + 2,
            place=(n, -1.5, 0.25),
            best=BestFrame(SourceFrame(0, n), n + 0.125, (0.5, 0.5)) if n < 3 else None,
        )
        for n, label in enumerate(NASTY)
    ]
    evidence = [Evidence(n, n, f"D{n} {label}", (), None) for n, label in enumerate(NASTY)]
    return gallery_page(frames, len(frames) + 1, rows, lines, label_colors([row.label for row in rows]), evidence)
