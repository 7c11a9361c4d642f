"""The documents say what the code writes."""

from __future__ import annotations

import re
from pathlib import Path

from core.advice import FLAG_ADVICE
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
    rows = re.findall(r"^\| `(\w+)` \| (.*) \| (.*) \|$", (DOCS / "flags.md").read_text("utf-8"), re.MULTILINE)
    assert {code: meaning for code, meaning, _ in rows} == dict(FLAG_CODES)
    assert {code: advice for code, _, advice in rows} == dict(FLAG_ADVICE)


def test_every_flag_says_what_to_do() -> None:
    assert set(FLAG_ADVICE) == set(FLAG_CODES)
    assert all(re.fullmatch(r"[A-Z].*\.", advice) for advice in FLAG_ADVICE.values())
