"""A small run as a record: the thesis's numbers where it has them, so that its tables can be recomputed."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from core.products.search import CaseProduct
from core.report.record import RunRecord, RunTables, TaskRecord
from core.scene.detection import Detection
from core.scene.frame import Frame, Role, RunFrames
from core.settings import make_settings
from core.stage_specs import STAGES
from core.states import RunState, TaskState
from core.task_key import stage_of
from core.thesis.grouping import cluster_detections, defect_records, event_rows, with_defect_ids
from tests.core.making_products import facts_of
from tests.core.making_rows import mapped, unplaced


def case(name: str, images: int, points: int, seconds: float = 2.0) -> TaskRecord:
    kind = {"seg": "coarse"}.get(name.split("_")[0], name.split("_")[0])
    start, end = (int(part) for part in name.split("_")[-2:])
    facts = facts_of(
        CaseProduct,
        name=name,
        kind=kind,
        start=start,
        end=end,
        status="succeeded" if images else "no_model",
        reason="" if images else "no_initial_pair",
        frames=end - start,
        models=1 if images else 0,
        registered_images=images,
        points3D=points,
        mean_reprojection_error_px=1.2 if images else None,
        median_reprojection_error_px=1.1 if images else None,
        start_mode="scratch",
    )
    return TaskRecord(f"{kind}/{name}", TaskState.SUCCEEDED, seconds=seconds, peak_rss_bytes=1000 * images, facts=facts)


CASES = [
    case("seg_006_0120_0300", 180, 54_478),
    case("seg_014_0280_0450", 41, 14_593),
    case("seg_021_0420_0450", 30, 9_655),
    case("refine_005_0090_0310", 220, 65_087),
    case("refine_010_0140_0360", 0, 0),
]


def _tables() -> RunTables:
    rows = [
        mapped(0, (0.0, 0, 0), 1.0, frame=1),
        mapped(1, (0.1, 0, 0), 1.1, frame=2),
        mapped(2, (5.0, 0, 0), 1.2, "crack", frame=2),
        unplaced(3, "no_registered_view", time_s=9.0, source_index=90),
        unplaced(4, "no_support", time_s=1.1, source_index=11),
        unplaced(5, "no_frame", time_s=99.0, source_index=None),
    ]
    source = [10, 11, 12, 90, 11, None]
    detections = [
        Detection(row.id, row.key, row.time_s, row.label, row.score, row.box, source_index=shown)
        for row, shown in zip(rows, source, strict=True)
    ]
    frames = RunFrames(tuple(Frame(i, 9 + i, 100 * i, 0.9 + 0.1 * i, "ab" * 32, Role.SAMPLED) for i in range(5)))
    clusters = cluster_detections(rows, 1.0)
    supports = {row.id: np.array([[row.x, row.y, row.z]]) for row in rows if row.x is not None}
    return RunTables(
        detections=detections,
        frames=frames,
        registered=[0, 1, 2, 3],
        mapped_rows=with_defect_ids(rows, clusters),
        timeline=event_rows(clusters),
        defects=defect_records(
            clusters, event_rows(clusters), supports, [[] for _ in clusters], [[] for _ in clusters]
        ),
    )


def full_record(preset: str = "default", **options: Any) -> RunRecord:
    """A run that came to its end."""

    def task(key: str, **members: Any) -> TaskRecord:
        facts = facts_of(STAGES[stage_of(key)].product, **members)
        return TaskRecord(key, TaskState.SUCCEEDED, seconds=1.5, peak_rss_bytes=10, facts=facts)

    tasks = [
        task("probe", n_frames=360),
        task("annotations", n_keys=3745, n_detections=6),
        task("frames", n_frames=5, n_search=5, crop=[38, 79, 825, 604], flags=[]),
        task("features/000"),
        replace(task("features/001"), peak_rss_bytes=99),
        task("graph", n_pairs=7),
        *CASES,
        task("reduce_coarse", best="seg_006_0120_0300"),
        task("reduce_refine", best="refine_005_0090_0310"),
        task(
            "extend",
            registered_images=4,
            points3D=65_087,
            mean_reprojection_error_px=1.1958,
            median_reprojection_error_px=1.1281,
            checks=[],
        ),
        task("fuse", n_points=870_096),
        task("mesh", n_vertices=1_375_199, n_faces=2_711_283, diagonal_su=10.0, supported_share=0.8),
        task("map_defects", unique_support_points=2457),
        task("timeline", n_events=2),
        task("gallery", n_images=3),
    ]
    return RunRecord(
        settings=make_settings(preset, options),
        state=RunState.SUCCEEDED,
        tasks=tasks,
        tables=_tables(),
        inputs={"video": "aa", "annotations": "bb"},
        versions={"bladeatlas": "0.1.0"},
    )


def with_check(record: RunRecord, code: str, severity: str) -> RunRecord:
    """The same run with a check of `extend` that found something."""
    flag = {"code": code, "severity": severity, "value": 3.0, "threshold": 1.0, "where": "model"}
    tasks = [
        replace(task, facts={**task.facts, "checks": [flag]}) if task.key == "extend" else task for task in record.tasks
    ]
    return replace(record, tasks=tasks)


def failed_record(preset: str = "default") -> RunRecord:
    """A run whose search found no model at all: the plan knows only what was reached."""
    full = full_record(preset)
    flag = {"code": "no_parallax", "severity": "error", "value": 0.1, "threshold": 1.0, "where": "all pairs"}
    tasks = []
    for task in full.tasks[:6]:
        tasks.append(replace(task, facts={**task.facts, "flags": [flag]}) if task.key == "graph" else task)
    tasks.append(case("seg_000_0000_0030", 0, 0))
    tasks.append(TaskRecord("coarse/seg_001_0020_0050", TaskState.FAILED, reason="stage_failed", message="crashed"))
    tasks.append(
        TaskRecord("reduce_coarse", TaskState.FAILED, reason="no_reconstruction", message="no case has a model")
    )
    tables = replace(full.tables, registered=[], mapped_rows=None, timeline=[], defects=[])
    return replace(
        full,
        state=RunState.FAILED,
        tasks=tasks,
        tables=tables,
        failed_stage="reduce_coarse",
        reason="no_reconstruction",
        message="no case has a model",
    )
