"""Tables of several models joined: every detection once, ids told apart."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from core.flags import Verdict
from core.io.annotations import write_rows
from core.io.frames import write_registered
from core.io.timeline import write_timeline
from core.products.contract import Products
from core.products.front import CameraProduct
from core.products.search import ExtendProduct, PassedProduct, ReverifyProduct
from core.report.build import build_report
from core.report.load import join_detections, load_tables, served_submodels
from core.report.quality import build_quality, collect_flags
from core.report.record import TaskRecord
from core.report.rows import case_rows, detection_rows, frame_rows
from core.scene.defect import EventRow
from core.scene.detection import DetectionRow, Outcome
from core.states import TaskState
from core.timeline.grouping import Start
from tests.core.making_products import facts_of
from tests.core.making_record import case, full_record
from tests.core.making_rows import defect, mapped, unplaced


def row(number: int, outcome: str, model: int | None = None) -> DetectionRow:
    return replace(unplaced(number), outcome=Outcome(outcome), model=model)


def test_every_detection_takes_the_model_that_placed_it_best() -> None:
    first = [row(0, "mapped", 0), row(1, "unplaced"), row(2, "approximate", 0), row(3, "approximate", 0)]
    second = [row(0, "approximate", 1), row(1, "approximate", 1), row(2, "mapped", 1), row(3, "approximate", 1)]
    assert [one.model for one in join_detections([first, second])] == [0, 1, 1, 0]
    assert join_detections([first]) == first
    assert join_detections([]) == []


def test_ids_go_on_over_the_models() -> None:
    facts = {
        "timeline": {"n_defects": 3, "n_events": 5},
        "timeline@1": {"n_defects": 2, "n_events": 2},
        "timeline@2": {"n_defects": 9, "n_events": 9},
        "mesh": {"n_faces": 4},
    }
    assert Start.after(Products(facts), 0) == Start(0, 0)
    start = Start.after(Products(facts), 2)
    assert start == Start(5, 7)
    placed = replace(mapped(0, (0.0, 0.0, 0.0), 1.0, frame=1), defect_id=1)
    assert [one.defect_id for one in start.rows([placed, unplaced(1, "no_frame", time_s=2.0, source_index=None)])] == [
        6,
        None,
    ]
    event = EventRow(0, 1, "dent", 0.0, 1.0, 1, 1, 0.0, 0.0, 0.0, 1.0, 0.5)
    assert [(one.event_id, one.defect_id) for one in start.events([event])] == [(7, 6)]
    known = replace(defect(1), events=(0, 1), evidence="gallery/defect_001.jpg")
    assert start.records([known]) == [replace(known, id=6, events=(7, 8), evidence="gallery/defect_006.jpg")]
    assert start.vertices(np.array([-1, 0, 2], np.int32)).tolist() == [-1, 5, 7]


def folders(tmp_path: Path, *pieces: int) -> dict[str, Path]:
    made = {}
    for number in pieces:
        mark = f"@{number}" if number else ""
        for stage in ("extend", "timeline"):
            made[stage + mark] = tmp_path / (stage + mark)
            made[stage + mark].mkdir()
        write_registered(made["extend" + mark], [number, number + 10])
        write_rows(made["timeline" + mark], [row(0, "mapped" if number else "unplaced", number)])
        write_timeline(made["timeline" + mark], [], [replace(defect(number), model=number)], [])
    return made


def test_only_models_that_came_to_their_end_are_served(tmp_path: Path) -> None:
    made = folders(tmp_path, 0, 1, 2)
    del made["timeline@1"]
    assert served_submodels(made) == [2]
    tables = load_tables(made)
    assert tables.registered == [0, 10]
    assert tables.registered_further == {2: [2, 12]}
    assert [one.model for one in tables.mapped_rows or ()] == [2]
    assert [one.id for one in tables.defects] == [0, 2]
    del made["timeline"]
    assert served_submodels(made) == []


def test_the_report_says_which_model_a_frame_and_a_warning_belong_to() -> None:
    record = full_record()
    free = [f.index for f in record.tables.frames if f.index not in record.tables.registered][:1]
    taken = record.tables.registered[0]
    check = {"code": "weak_join", "severity": "warning", "value": 20.0, "threshold": 30.0, "where": "frame 4"}
    facts = facts_of(ExtendProduct, registered_images=12, points3D=900, checks=[check])
    record = replace(
        record,
        tasks=[*record.tasks, TaskRecord("extend@1", TaskState.SUCCEEDED, facts=facts)],
        tables=replace(record.tables, registered_further={1: [*free, taken]}),
    )
    models = {one.index: one.model for one in frame_rows(record)}
    assert models[taken] == 0, "a frame belongs to the first model that has it"
    assert [models[index] for index in free] == [1] * len(free)
    flags = collect_flags(record)
    assert "model 1, frame 4" in [flag.where for flag in flags]
    quality = build_quality(record, Verdict.OK, flags, case_rows(record), detection_rows(record, False))
    assert [(one["model"], one["registered_images"]) for one in quality["models"]][-1] == (1, 12)


@pytest.mark.parametrize(
    ("of_rows", "of_defects", "where", "least"),
    [
        ((0, 0), (0, 0, 0), None, 3),
        ((0, 1), (0, 0, 1), "models 0, 1", 2),
        ((0, 0), (0, 2, 2), "models 0, 2", 2),  # a defect without a row of its own: its detections count for model 0
        ((0, None), (0, 0), None, 2),
    ],
)
def test_with_defects_in_several_models_the_count_is_a_range_and_the_verdict_not_ok(
    of_rows: tuple[int | None, ...], of_defects: tuple[int, ...], where: str | None, least: int
) -> None:
    record = full_record()
    rows = [row(n, "unplaced" if model is None else "mapped", model) for n, model in enumerate(of_rows)]
    defects = [replace(defect(n), model=model) for n, model in enumerate(of_defects)]
    record = replace(record, tables=replace(record.tables, mapped_rows=rows, defects=defects))
    report = build_report(record)
    flags = {flag["code"]: flag["where"] for flag in report.quality["flags"]}
    assert flags == ({} if where is None else {"several_models": where})
    assert report.verdict == (Verdict.OK if where is None else Verdict.SUSPECT)
    for numbers in (report.summary["headline"], report.quality["funnel"]):
        assert (numbers["defects_at_least"], numbers["defects"]) == (least, len(defects))


def test_the_part_of_a_rejected_model_is_the_selected_case() -> None:
    record = full_record()
    flag = {"code": "parts_after_veto", "severity": "warning", "where": "frames 0-29 of seg_006_0120_0300"}
    part = case("section_000_0000_0030", 30, 900)
    reducer = TaskRecord(
        "reduce_parts",
        TaskState.SUCCEEDED,
        facts=facts_of(PassedProduct, best="section_000_0000_0030", kind="section", flags=[flag]),
    )
    report = build_report(replace(record, tasks=[*record.tasks, part, reducer]))
    assert report.verdict == Verdict.SUSPECT
    assert [flag["code"] for flag in report.quality["flags"]] == ["parts_after_veto"]
    assert [(row["name"], row["kind"]) for row in report.cases if row["selected"]] == [
        ("section_000_0000_0030", "section")
    ]
    assert report.quality["search"]["parts"]["registered_images_max"] == 30


@pytest.mark.parametrize("passed", [True, False])
def test_of_two_lenses_the_one_that_the_model_started_from_speaks(passed: bool) -> None:
    record = full_record()
    doubt = {"severity": "warning", "where": "camera"}
    fisheye = facts_of(CameraProduct, focal_from="colmap", flags=[{"code": "lens_unknown", **doubt}])
    other = facts_of(ReverifyProduct, focal_from="estimated", flags=[{"code": "focal_uncertain", **doubt}])
    name = "perspective_000_0000_0030"
    choice = facts_of(PassedProduct, best=name, flags=[{"code": "perspective_after_veto", **doubt}])
    tasks = [
        *(task for task in record.tasks if task.key != "camera"),
        TaskRecord("camera", TaskState.SUCCEEDED, facts=fisheye),
        TaskRecord("reverify", TaskState.SUCCEEDED, facts=other),
        case(name, 30, 900),
        TaskRecord(
            "reduce_perspective", TaskState.SUCCEEDED if passed else TaskState.FAILED, facts=choice if passed else {}
        ),
    ]
    report = build_report(replace(record, tasks=tasks))
    codes = [flag["code"] for flag in report.quality["flags"]]
    assert codes == (["focal_uncertain", "perspective_after_veto"] if passed else ["lens_unknown"])
    assert report.quality["lens"]["from"] == ("estimated" if passed else "colmap")
    assert (name in [row["name"] for row in report.cases if row["selected"]]) == passed
