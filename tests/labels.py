"""Annotations of the sample whose labels strangers wrote: formulas, markup, control characters, line breaks."""

from __future__ import annotations

from pathlib import Path

from tests.inputs import INPUTS

LABELS = INPUTS / "labels.json"
SAMPLE = Path(__file__).parents[1] / "samples" / "turbine.mp4"
