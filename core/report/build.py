"""One call from a run's record to everything the report consists of, and one that writes it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from core.flags import Verdict
from core.json_files import write_json
from core.outputs import DEFECTS, FRAMES, LIMITS, QUALITY, SUMMARY
from core.report.limits import limits_document
from core.report.quality import build_quality, collect_flags, verdict_of
from core.report.record import Document, Item, Row, RunRecord
from core.report.rows import case_rows, detection_rows, frame_rows
from core.report.summary import build_summary
from core.report.tables import write_csv
from core.scene.case import CASE_COLUMNS
from core.scene.defect import TIMELINE_COLUMNS
from core.scene.detection import DETECTION_COLUMNS
from core.scene.frame import FRAME_COLUMNS


@dataclass(frozen=True)
class Report:
    """Published tables and objects of a run, as plain JSON values."""

    verdict: Verdict
    summary: Document
    quality: Document
    frames: Sequence[Row]
    cases: Sequence[Row]
    detections: Sequence[Row]
    timeline: Sequence[Item]
    defects: Sequence[Item]
    limits: Document | None = None
    """The findings compared with the limits of the shop; None where none are told."""


def build_report(record: RunRecord) -> Report:
    """The report of a run that ended in whatever way. Pure: same record, same report.

    A refused run has no mapped row, no event and no defect, whatever its stages left behind.
    """
    flags = collect_flags(record)
    verdict = verdict_of(record, flags)
    refused = verdict == Verdict.REFUSED
    cases = case_rows(record)
    detections = detection_rows(record, refused)
    timeline = [] if refused else list(record.tables.timeline)
    defects = [] if refused else list(record.tables.defects)
    return Report(
        verdict=verdict,
        summary=build_summary(record, verdict, detections, timeline, defects),
        quality=build_quality(record, verdict, flags, cases, detections),
        frames=[row.to_dict() for row in frame_rows(record)],
        cases=[row.to_dict() for row in cases],
        detections=[row.to_dict() for row in detections],
        timeline=[row.to_dict() for row in timeline],
        defects=[row.to_dict() for row in defects],
        limits=limits_document(record.settings.limits.rows, defects) if record.settings.limits.table else None,
    )


def write_tables(report: Report, out_dir: Path) -> list[str]:
    """Write all tables of the report below `out_dir`; gives their relative paths. Empty tables are written too."""
    columns = {
        "cases": (CASE_COLUMNS, report.cases),
        "mapping/detections": (DETECTION_COLUMNS, report.detections),
        "mapping/timeline": (TIMELINE_COLUMNS, report.timeline),
    }
    write_json(out_dir / SUMMARY, report.summary)
    write_json(out_dir / QUALITY, report.quality)
    write_csv(out_dir / FRAMES, FRAME_COLUMNS, report.frames)
    written = [SUMMARY, QUALITY, FRAMES]
    for name, (names, rows) in columns.items():
        write_csv(out_dir / f"{name}.csv", names, rows)
        write_json(out_dir / f"{name}.json", list(rows))
        written += [f"{name}.csv", f"{name}.json"]
    write_json(out_dir / DEFECTS, list(report.defects))
    if report.limits is not None:
        write_json(out_dir / LIMITS, report.limits)
        written.append(LIMITS)
    return [*written, DEFECTS]
