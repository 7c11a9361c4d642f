"""What holds after all records: the cases that the page is held to as well (`web/test/review.test.ts`)."""

from __future__ import annotations

import json
import random
from pathlib import Path
from typing import Any

import pytest

from core.review.record import ReviewRecord
from core.review.state import fold
from core.review.target import Target

CASES: list[dict[str, Any]] = json.loads((Path(__file__).parents[2] / "data" / "review_cases.json").read_text("utf-8"))


@pytest.mark.parametrize("case", CASES, ids=lambda case: str(case["name"]))
def test_what_holds_after_all_records(case: dict[str, Any]) -> None:
    records = [ReviewRecord.parse(one, "record") for one in case["records"]]
    defects = [Target.parse(one, "defect") for one in case["defects"]]
    reviewed = fold(records, defects)
    said = {one.name: one.review.to_dict() for one in reviewed.findings}
    assert [one.name for one in reviewed.unattached] == case["unattached"]
    assert set(said) == set(case["expected"]) | {f"D{one.id}" for one in defects}
    for name, expected in case["expected"].items():
        assert {member: said[name][member] for member in expected} == expected, name
    assert reviewed.revision == len(records)


@pytest.mark.parametrize("case", CASES, ids=lambda case: str(case["name"]))
def test_records_come_back_from_their_json_and_in_any_order(case: dict[str, Any]) -> None:
    records = [ReviewRecord.parse(one, "record") for one in case["records"]]
    again = [ReviewRecord.parse(json.loads(json.dumps(one.to_dict())), "record") for one in records]
    assert again == records
    defects = [Target.parse(one, "defect") for one in case["defects"]]
    random.Random(3).shuffle(again)
    assert fold(again, defects) == fold(records, defects)


def test_every_record_is_told_of_somewhere() -> None:
    """None is lost: whatever was said shows in a finding or among the unattached."""
    for case in CASES:
        records = [ReviewRecord.parse(one, "record") for one in case["records"]]
        reviewed = fold(records, [])  # as after an attempt that found nothing
        notes = [one.value for one in records if one.action == "note"]
        told = [note.text for one in (*reviewed.findings, *reviewed.unattached) for note in one.review.notes]
        assert sorted(map(str, notes)) == sorted(told), case["name"]
