"""Eight questions of an inspector, and what the tables of a result answer."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from enum import StrEnum
from pathlib import Path

from core.errors import BadInput
from core.json_files import JsonObject, read_json
from core.outputs import DEFECTS, DETECTIONS, FRAMES, ROW, SUMMARY
from core.report.csv_form import read_csv

UNKNOWN = "unknown"
MIDDLE = 0.5
"""A place beyond the middle of the span seen is nearer to the tip."""


class Task(StrEnum):
    """What is asked."""

    COUNT = "How many findings are there?"
    LARGEST = "Which finding is the largest?"
    BLADE = "Which blade has most findings?"
    BEST_FRAME = "Which frame shows the largest finding best?"
    SPAN = "Where along the span does it lie?"
    ROOT_OR_TIP = "Is it nearer to the root or to the tip?"
    NOT_SEEN = "Which blade was seen least?"
    SAME = "Which finding is this box in the picture?"


def answers(result: Path) -> Mapping[Task, frozenset[str]]:
    """Every right answer to each question, from the tables of the first model.

    A question that the tables do not answer has the answer `UNKNOWN`.

    Raises:
        BadInput: the folder is no result, or has no finding.
    """
    if not (result / SUMMARY).is_file():
        raise BadInput(f"'{result}' has no {SUMMARY}: is it a finished result?", where="RESULT")
    records: list[JsonObject] = [one for one in read_json(result / DEFECTS) if not one.get("model")]
    if not records:
        raise BadInput(f"'{result}' has no finding to ask about", where="RESULT")
    first = largest(records)
    blades = Counter(str(one["blade"]) for one in records if one.get("blade") is not None)
    most = {blade for blade, count in blades.items() if count == max(blades.values())}
    span = first.get("span")
    return {
        Task.COUNT: frozenset({str(len(records))}),
        Task.LARGEST: frozenset({f"D{first['id']}"}),
        Task.BLADE: frozenset(most or {UNKNOWN}),
        Task.BEST_FRAME: frozenset({_best_frame(result, first)}),
        Task.SPAN: frozenset({UNKNOWN if span is None else f"{100 * span:.0f}"}),
        Task.ROOT_OR_TIP: frozenset({UNKNOWN if span is None else "tip" if span > MIDDLE else "root"}),
        Task.NOT_SEEN: _least_seen(result),
        Task.SAME: frozenset({f"D{boxed_finding(result)}"}),
    }


def largest(records: list[JsonObject]) -> JsonObject:
    """The record with the greatest length, where none was measured extent; of equal ones the first."""

    def size(one: JsonObject) -> float:
        value = one.get("length")
        return float((one.get("extent") or {}).get("value") or 0.0) if value is None else float(value)

    return max(records, key=lambda one: (size(one), -one["id"]))


def boxed_finding(result: Path) -> int:
    """The finding whose box is asked about: that of the first detection that belongs to one."""
    return int(boxed(result)["defect_id"])


def boxed_frame(result: Path) -> int:
    """Index of the frame with that box, among the frames of the run."""
    return int(boxed(result)["frame_index"])


def boxed(result: Path) -> JsonObject:
    """The row of the detection whose box is asked about: the first of a finding that is alone on its frame, else the
    first of a finding."""
    rows: list[JsonObject] = read_json(result / DETECTIONS)
    own = [one for one in rows if one["defect_id"] is not None and one["frame_index"] is not None]
    # A frame with one box leaves no doubt which is meant.
    alone = Counter(one["frame_index"] for one in rows)
    return next((one for one in own if alone[one["frame_index"]] == 1), own[0])


def _best_frame(result: Path, record: JsonObject) -> str:
    """Number in its video of the best view that detected it, of all where none did."""
    views = record["frames"]
    best = next((one for one in views if one["detected"]), views[0])
    source = {int(row["index"]): row["source_index"] for row in read_csv(result / FRAMES)}
    return source[best["frame_index"]]


def _least_seen(result: Path) -> frozenset[str]:
    """Blades of which the smallest share is seen by two views, in whole per cent."""
    row = read_json(result / ROW) if (result / ROW).is_file() else {}
    seen = {str(one["blade"]): round(100 * one["views_2"]) for one in row.get("coverage") or ()}
    return frozenset({blade for blade, share in seen.items() if share == min(seen.values())} or {UNKNOWN})
