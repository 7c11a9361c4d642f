"""`bladeatlas review`: what people say of the findings of a result folder, and records added to it."""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from cli.terminal import say, say_json
from core.json_files import read_json
from core.outputs import DEFECTS
from core.report.csv_form import csv_line
from core.review.published import Applied, apply_records, read_review, reviewed_result
from core.review.record import ReviewRecord
from core.review.state import Reviewed, ReviewedFinding
from core.review.tables import REVIEW_COLUMNS, review_cells
from core.review.words import Action, TargetKind

_MACHINE = ("id", "label", "model", "blade")


def command(parsed: argparse.Namespace) -> int:
    """Add the records of files to a result, then tell what holds of its findings."""
    folder: Path = parsed.result
    reviewed_result(folder)  # what is no result is said before a file is written
    for path in parsed.apply:
        told = apply_records(folder, placed(folder, read_review(path)))
        if not parsed.json and not parsed.csv:
            say(_added(path, told))
    found = reviewed_result(folder)
    if parsed.json:
        say_json({"schema_version": 1, **found.reviewed.to_dict()}, indent=1)
    elif parsed.csv:
        for line in csv_lines(found.reviewed, read_json(folder / DEFECTS)):
            sys.stdout.write(line)
    else:
        say(*lines(found.reviewed))
    return 0


def placed(folder: Path, records: Sequence[ReviewRecord]) -> list[ReviewRecord]:
    """The records, with a place for drawn findings whose record never had one: their box is cast onto the surface.

    Raises:
        BadInput: a box is on a frame that the run does not have, or the result lacks what it would be cast on.
    """
    return [_placed(folder, one) if _is_uncast(one) else one for one in records]


def _is_uncast(record: ReviewRecord) -> bool:
    value = record.value
    return record.action == Action.ADD and isinstance(value, dict) and value.get("unplaced") == "not_cast"


def _placed(folder: Path, record: ReviewRecord) -> ReviewRecord:
    # Loaded here: casting needs the ray caster, everything else does not.
    from core.query import Result

    value = record.value
    assert isinstance(value, dict)  # as `_is_uncast` saw
    shown = Result(folder, record.target.model).place_of_box(value["frame"], value["box"])
    if shown.point is None:
        return replace(record, value={**value, "unplaced": str(shown.reason)})
    kept = {name: member for name, member in value.items() if name != "unplaced"}
    return replace(record, value={**kept, "point": list(shown.point), "normal": list(shown.normal or ())})


def _added(path: Path, told: Applied) -> str:
    known = f", {told.known} were there already" if told.known else ""
    return f"{path.name}: {told.added} records added{known}"


def lines(reviewed: Reviewed) -> Iterator[str]:
    """What holds, for people: a line for each finding, then what is not attached."""
    counts = Counter(str(one.review.state) for one in reviewed.findings)
    told = ", ".join(f"{count} {state}" for state, count in sorted(counts.items()))
    yield f"{len(reviewed.findings)} findings: {told}" if told else "no findings"
    for one in reviewed.findings:
        yield f"  {one.name:5} {_words(one)}"
    if reviewed.unattached:
        yield f"{len(reviewed.unattached)} reviews of findings that this result does not have:"
        for one in reviewed.unattached:
            yield f"  {one.name:5} {_words(one)}"


def _words(one: ReviewedFinding) -> str:
    review = one.review
    label = one.target.label if review.label is None else f"{one.target.label} -> {review.label}"
    told = [str(review.state), review.reason, review.severity or ""]
    told += [f"into {review.merged_into}" if review.merged_into else ""]
    told += [f"blade {review.blade or 'none'}" if review.blade is not None else ""]
    told += ["moved" if review.point else "", f"{len(review.notes)} notes" if review.notes else ""]
    return f"{label}: {', '.join(filter(None, told))}"


def csv_lines(reviewed: Reviewed, defects: Sequence[dict[str, object]]) -> Iterator[str]:
    """The findings as CSV: some of the machine's columns, then people's; what people made has none of the machine's."""
    rows = {one["id"]: one for one in defects}
    yield csv_line([*_MACHINE, *REVIEW_COLUMNS])
    for one in reviewed.findings:
        machine = rows.get(one.target.id, {}) if one.target.kind == TargetKind.DEFECT else {}
        cells = review_cells(one)
        yield csv_line([*(machine.get(name) for name in _MACHINE), *(cells[name] for name in REVIEW_COLUMNS)])
