"""The documents say what the code writes."""

from __future__ import annotations

import re
from pathlib import Path

from core.flags import FLAG_CODES
from core.report.build import build_report
from core.scene.detection import REASONS
from tests.core.making_record import full_record

DOCS = Path(__file__).parents[3] / "docs"
OUTPUTS = (DOCS / "outputs.md").read_text(encoding="utf-8")


def test_reasons_are_documented() -> None:
    assert set(REASONS) <= set(re.findall(r"^\| `(\w+)` \|", OUTPUTS, re.MULTILINE))


def test_keys_of_the_two_objects_are_documented() -> None:
    report = build_report(full_record())
    named = set(re.findall(r"\w+", " ".join(re.findall(r"`([^`]*)`", OUTPUTS))))
    assert set(report.summary) | set(report.quality) <= named


def test_flags_are_documented() -> None:
    documented = dict(re.findall(r"^\| `(\w+)` \| (.*) \|$", (DOCS / "flags.md").read_text("utf-8"), re.MULTILINE))
    assert documented == dict(FLAG_CODES)
