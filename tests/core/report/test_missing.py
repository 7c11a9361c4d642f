"""A result that lacks something is never `ok`, and says what it lacks."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from core.products.search import ExtendProduct
from core.products.surface import MeshProduct
from core.report.build import build_report
from core.report.losses import AFTER_MODEL
from core.report.record import RunRecord, TaskRecord
from core.scene.detection import Outcome, Reason
from core.states import RunState, TaskState
from tests.core.making_products import facts_of
from tests.core.making_record import failed_record, full_record

ORDER = ("undistort", "fuse", "mesh", "map_defects", "timeline", "gallery")


def broken(stage: str, reason: str, **more: Any) -> RunRecord:
    """The run ends in this stage: all behind it is skipped, and no table is made of it."""
    full = full_record()
    lost = ORDER[ORDER.index(stage) :]
    tasks = [task for task in full.tasks if task.stage not in lost]
    tasks.append(TaskRecord(stage, TaskState.FAILED, reason=reason))
    tasks += [TaskRecord(name, TaskState.SKIPPED) for name in lost[1:]]
    tables = full.tables
    if "map_defects" in lost:
        tables = replace(tables, mapped_rows=None, timeline=[], defects=[])
    values = {"state": "partial", "failed_stage": stage, "reason": reason, **more}
    return replace(full, tasks=tasks, tables=tables, **values)


def flags_of(record: RunRecord) -> dict[str, str]:
    return {flag["code"]: flag["where"] for flag in build_report(record).quality["flags"]}


@pytest.mark.parametrize(
    ("stage", "reason", "codes"),
    [
        ("undistort", "stage_failed", {"incomplete", "no_surface", "nothing_mapped"}),
        ("fuse", "empty_cloud", {"incomplete", "no_surface", "nothing_mapped"}),
        ("mesh", "empty_mesh", {"incomplete", "no_surface", "nothing_mapped"}),
        ("map_defects", "timeout", {"incomplete", "nothing_mapped"}),
        ("timeline", "oom", {"incomplete"}),
        ("gallery", "disk_full", {"incomplete"}),
    ],
)
@pytest.mark.parametrize("state", ["partial", "failed"])
def test_a_stage_that_fails_after_the_model_makes_the_result_suspect(
    stage: str, reason: str, codes: set[str], state: str
) -> None:
    record = broken(stage, reason, state=state)
    assert build_report(record).quality["verdict"] == "suspect"
    assert build_report(record).summary["verdict"] == "suspect"
    assert set(flags_of(record)) == codes
    assert flags_of(record)["incomplete"] == f"{stage}: {reason}"


def test_a_run_that_was_cancelled_after_its_model_is_suspect() -> None:
    full = full_record()
    tasks = [replace(task, state=TaskState.CANCELLED) if task.key == "gallery" else task for task in full.tasks]
    record = replace(full, state=RunState.CANCELLED, reason="cancelled", tasks=tasks)
    assert build_report(record).quality["verdict"] == "suspect"
    assert flags_of(record) == {"incomplete": "cancelled"}


@pytest.mark.parametrize("facts", [{}, facts_of(MeshProduct, n_faces=0, n_vertices=3)])
def test_an_empty_surface_is_told_whatever_the_state(facts: dict[str, Any]) -> None:
    full = full_record()
    tasks = [replace(task, facts=facts) if task.key == "mesh" else task for task in full.tasks]
    record = replace(full, tasks=tasks)
    assert build_report(record).quality["verdict"] == "suspect"
    assert flags_of(record) == {"no_surface": "mesh"}


def test_a_run_that_placed_nothing_is_told_unless_there_was_nothing_to_place() -> None:
    full = full_record()
    rows = [replace(row, outcome=Outcome.UNPLACED, reason=Reason.OFF_SURFACE) for row in full.tables.mapped_rows or ()]
    tables = replace(full.tables, mapped_rows=rows, timeline=[], defects=[])
    assert flags_of(replace(full, tables=tables)) == {"nothing_mapped": "5 detections"}
    nothing = replace(tables, detections=[], mapped_rows=[])
    assert build_report(replace(full, tables=nothing)).quality["verdict"] == "ok"
    outside = replace(tables, detections=[replace(row, source_index=None) for row in full.tables.detections])
    assert flags_of(replace(full, tables=outside)) == {}


def test_a_further_model_that_lost_its_surface_is_told_and_one_that_never_was_is_not() -> None:
    full = full_record()
    model = TaskRecord("extend@1", TaskState.SUCCEEDED, facts=facts_of(ExtendProduct, registered_images=9))
    lost = [TaskRecord("fuse@1", TaskState.FAILED, reason="empty_cloud"), TaskRecord("mesh@1", TaskState.SKIPPED)]
    record = replace(full, tasks=[*full.tasks, model, *lost])
    assert flags_of(record) == {"incomplete": "model 1, fuse: empty_cloud"}
    assert build_report(record).quality["verdict"] == "suspect"
    never = replace(
        full, tasks=[*full.tasks, TaskRecord("extend@1", TaskState.FAILED, reason="no_reconstruction"), *lost[1:]]
    )
    assert build_report(never).quality["verdict"] == "ok"


def test_without_a_model_the_run_is_refused_for_its_own_reasons() -> None:
    refused = replace(full_record(), state=RunState.FAILED, reason="no_reconstruction")
    for record in (failed_record(), refused):
        assert not {"incomplete", "no_surface", "nothing_mapped"} & set(flags_of(record))


def test_the_stages_after_the_model() -> None:
    assert {"pieces", *ORDER, "viewer", "row", "blades", "depth", "geometric"} == AFTER_MODEL
