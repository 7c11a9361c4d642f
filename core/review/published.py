"""The review of a result folder: records in `review.json` beside the files of the result, which never change."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from filelock import FileLock, Timeout

from core.errors import BadInput
from core.json_files import JsonObject, read_json, replace_file, write_json
from core.outputs import DEFECTS
from core.review.checks import bad, index, require_member
from core.review.record import ReviewRecord
from core.review.state import Reviewed, fold
from core.review.target import Target
from core.review.words import Action

REVIEW = "review.json"
"""In the result folder: the records, in the form that the page and the service hand over."""
LOCK = ".review.lock"
"""Beside it: held while records are added, so that two who add at once lose nothing."""
SCHEMA_VERSION = 2
MAX_RECORDS = 100_000
"""Records that one result may have."""
_MAX_BYTES = 64 << 20
_PATIENCE_S = 30.0
"""How long another who adds records is waited for; adding takes well under a second."""
_MEMBERS = (
    *("schema_version", "title", "fingerprint", "model", "records"),
    *("inspection", "revision", "severities", "may_review", "you"),
)


@dataclass(frozen=True)
class Applied:
    """What came of records that were handed over."""

    added: int
    known: int
    """Records that were there already."""


@dataclass(frozen=True)
class ReviewedResult:
    """A result folder after review."""

    records: tuple[ReviewRecord, ...]
    """In the order of their revisions."""
    reviewed: Reviewed


def reviewed_result(folder: Path) -> ReviewedResult:
    """The findings of a finished result with what its `review.json` says of them; without that file all are open.

    Args:
        folder: the result, with `mapping/defects.json`.

    Raises:
        BadInput: the result has no findings file, or its review cannot be read.
    """
    path = folder / DEFECTS
    if not path.is_file():
        raise BadInput(f"{folder.name} has no {DEFECTS}: is it a finished result?", where=DEFECTS)
    records = kept_records(folder)
    defects = [Target.of_defect(one) for one in read_json(path)]
    return ReviewedResult(tuple(records), fold(records, defects))


def kept_records(folder: Path) -> list[ReviewRecord]:
    """The records beside a result, by revision; none where nobody reviewed it.

    Raises:
        BadInput: the file is no review.
    """
    path = folder / REVIEW
    return read_review(path) if path.exists() else []


def read_review(path: Path) -> list[ReviewRecord]:
    """Records of a file that the page saved, the service gave, or this program wrote, by revision.

    Raises:
        BadInput: it is none, or a record in it is not valid; the message names the member.
    """
    try:
        if path.stat().st_size > _MAX_BYTES:
            raise BadInput(f"'{path.name}' is too large for a review", code="bad_review", where=path.name)
        document = json.loads(path.read_text(encoding="utf-8-sig"))
    except (OSError, ValueError, RecursionError) as error:
        said = error.strerror if isinstance(error, OSError) else error
        raise BadInput(f"'{path.name}' cannot be read: {said}", code="bad_review", where=path.name) from None
    return parse_review(document, path.name)


def parse_review(document: object, where: str) -> list[ReviewRecord]:
    """Records of the object of a `review.json`, by revision.

    Raises:
        BadInput: it is none, or a record in it is not valid; the message names the member.
    """
    row = require_member(document, where, _MEMBERS)
    if row.get("schema_version") not in (1, SCHEMA_VERSION):
        raise bad(where, f"is of another version than 1 or {SCHEMA_VERSION}")
    rows = row.get("records")
    if not isinstance(rows, list) or len(rows) > MAX_RECORDS:
        raise bad(f"{where}.records", f"must be a list of at most {MAX_RECORDS} records")
    if row["schema_version"] == 1:
        rows = _with_ids(rows)
    records = [ReviewRecord.parse(one, f"{where}.records[{number}]") for number, one in enumerate(rows)]
    return sorted(records, key=lambda one: one.revision)


def merged(kept: Sequence[ReviewRecord], others: Sequence[ReviewRecord]) -> list[ReviewRecord]:
    """`kept`, and behind them those of `others` that are not among them, numbered on."""
    known = {one.id for one in kept}
    new = [one for one in {one.id: one for one in others}.values() if one.id not in known]
    last = max((one.revision for one in kept), default=0)
    return [*kept, *(one.kept(last + number) for number, one in enumerate(new, 1))]


def apply_records(folder: Path, records: Sequence[ReviewRecord]) -> Applied:
    """Add records to the review of a result; those that it has already are left, whoever hands them over again.

    Raises:
        BadInput: the folder cannot be written, another holds it too long, or it would have too many records.
    """
    lock = FileLock(
        folder / LOCK, timeout=_PATIENCE_S, fallback_to_soft=False
    )  # the kernel's: who is killed holds none
    try:
        held = lock.acquire()
    except Timeout:
        raise BadInput(f"another adds records to '{folder}'", code="folder_in_use", where=REVIEW) from None
    except OSError as error:
        raise _cannot_write(error) from None
    with held:
        return _added(folder, records)


def _added(folder: Path, records: Sequence[ReviewRecord]) -> Applied:
    """Add them; the lock is held."""
    kept = kept_records(folder)
    together = merged(kept, records)
    if len(together) > MAX_RECORDS:
        raise BadInput(f"a result has at most {MAX_RECORDS} review records", code="bad_review", where=REVIEW)
    if len(together) > len(kept):
        try:
            replace_file(folder / REVIEW, lambda beside: write_json(beside, review_document(together)))
        except OSError as error:
            raise _cannot_write(error) from None
    return Applied(len(together) - len(kept), len({one.id for one in records}) - (len(together) - len(kept)))


def _cannot_write(error: OSError) -> BadInput:
    return BadInput(f"{REVIEW} cannot be written: {error.strerror}", where=REVIEW)


def review_document(records: Sequence[ReviewRecord]) -> JsonObject:
    """The object of a `review.json`."""
    return {"schema_version": SCHEMA_VERSION, "records": [one.to_dict() for one in records]}


def _with_ids(rows: Sequence[object]) -> list[JsonObject]:
    """Records as pages wrote them before they had ids: an undo named the number of what it takes back."""
    found = [require_member(row, "records", _OF_VERSION_1) for row in rows]
    names = {index(row.get("revision"), "records.revision"): f"v1-{row['revision']}-{row.get('time')}" for row in found}
    return [{**row, "id": names[row["revision"]], "value": _named(row, names)} for row in found]


def _named(row: JsonObject, names: Mapping[int, str]) -> object:
    """The value of a record, where an undo names the record that it takes back by its id."""
    if row.get("action") != Action.UNDO:
        return row.get("value")
    return names.get(index(row.get("value"), "records.value"), "none")


_OF_VERSION_1 = ("revision", "target", "action", "value", "reason", "time")
