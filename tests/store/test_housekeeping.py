"""What may be removed and what not, on both databases."""

from __future__ import annotations

from dataclasses import replace
from datetime import timedelta

import pytest
from sqlalchemy import select, update

from core.errors import BadInput
from core.settings import make_settings
from store.db import Database
from store.graph import CORE_GRAPH, load_graph
from store.housekeeping import Retention
from store.inspections import Inspections
from store.models import Inspection, MetricRow, Result, Task, Upload
from store.plan import Plan
from store.records import InputFiles
from tests.store.small_plan import FILES, GRAPH, INPUT, result_for


@pytest.fixture
def retention(db: Database) -> Retention:
    """Two finished inspections of the same input, with all results in common."""
    for name in ("one", "two"):
        Inspections(db, GRAPH).create(name, FILES, make_settings(), "")
        finish(db)
    return Retention(db)


def finish(db: Database) -> None:
    plan = Plan(db, GRAPH)
    while (lease := plan.lease("me")) is not None:
        assert plan.complete(lease, result_for(lease, rows={"metrics": [{"name": "n", "value": 1.0}]}))


def mark(retention: Retention, name: str, **values: object) -> None:
    with retention.db.write() as session:
        session.execute(update(Inspection).where(Inspection.id == name).values(**values))


def later(retention: Retention, seconds: float) -> object:
    with retention.db.read() as session:
        return retention.db.now(session) + timedelta(seconds=seconds)


def unused(retention: Retention) -> list[str]:
    return Inspections(retention.db, GRAPH).unused()


def test_retention_marks_what_is_over_and_past_its_time(retention: Retention) -> None:
    mark(retention, "one", expires_at=later(retention, -1))
    mark(retention, "two", expires_at=later(retention, -1), state="running")
    assert retention.expire() == 1
    assert retention.expire() == 0
    assert retention.to_purge() == ["one"]


def test_a_purged_inspection_leaves_its_row_and_what_others_use(retention: Retention) -> None:
    mark(retention, "one", deleted_at=later(retention, 0))
    retention.purge("one")
    retention.purge("two")
    assert retention.to_purge() == []
    with retention.db.read() as session:
        assert set(session.scalars(select(Task.inspection_id))) == {"two"}
        assert set(session.scalars(select(MetricRow.inspection_id))) == {"two"}
        assert session.get_one(Inspection, "one").purged_at is not None
    assert unused(retention) == []
    assert retention.inputs_in_use() == {INPUT.video_sha256, INPUT.annotations_sha256}
    assert retention.logs_in_use() == {"two"}
    assert retention.folders_in_use() == {"inspections/two/0", "inspections/two/1"}
    mark(retention, "two", deleted_at=later(retention, 0))
    retention.purge("two")
    assert retention.inputs_in_use() == set()
    names = unused(retention)
    assert len(names) == len(retention.delete_unused(names)) == 6
    assert retention.known_fingerprints() == set()


def test_what_a_new_plan_took_up_meanwhile_is_not_forgotten(retention: Retention) -> None:
    with retention.db.read() as session:
        every = list(session.scalars(select(Result.fingerprint)))
    for name in ("one", "two"):
        mark(retention, name, deleted_at=later(retention, 0))
        retention.purge(name)
    Inspections(retention.db, GRAPH).create("three", FILES, make_settings(), "")
    assert retention.delete_unused(every) == []


def test_results_of_the_parameters_before_are_not_forgotten(retention: Retention) -> None:
    inspections = Inspections(retention.db, GRAPH)
    mark(retention, "two", deleted_at=later(retention, 0))
    retention.purge("two")
    with retention.db.read() as session:
        every = list(session.scalars(select(Result.fingerprint)))
    inspections.reopen("one", FILES, make_settings(options={"timeline.radius_fraction": 0.5}))
    finish(retention.db)
    assert retention.delete_unused(every) == []


def test_files_at_work_are_those_of_unfinished_or_unpublished_inspections(retention: Retention) -> None:
    assert len(retention.results_at_work()) == 6
    assert retention.inputs_at_work() == set()
    for name in ("one", "two"):
        mark(retention, name, published=1)
    assert retention.results_at_work() == set()
    other = (replace(INPUT, video_sha256="1" * 64, annotations=None, annotations_sha256=None),)
    Inspections(retention.db, GRAPH).create("three", other, make_settings(), "")
    assert retention.inputs_at_work() == {"1" * 64}


def test_uploads_end_when_their_time_is_over(retention: Retention) -> None:
    with retention.db.write() as session:
        now = retention.db.now(session)
        for name, seconds in (("old", -1), ("new", 60)):
            times = {"created_at": now, "updated_at": now, "expires_at": now + timedelta(seconds=seconds)}
            session.add(Upload(id=name, length=1, upload_metadata={}, **times))
    assert retention.expire_uploads() == 1
    assert retention.expire_uploads() == 0
    assert retention.uploads_in_use() == {"new"}


@pytest.mark.parametrize("name", ["store.graph:nothing", "nowhere:GRAPH", "store.graph:NO_RESULT", ""])
def test_a_graph_is_named_by_module_and_name(name: str) -> None:
    assert load_graph("store.graph:CORE_GRAPH") is CORE_GRAPH
    with pytest.raises(BadInput):
        load_graph(name)


def test_files_of_further_videos_are_in_use_as_long(retention: Retention) -> None:
    further = InputFiles("/w.mp4", "2" * 64, None, None)
    Inspections(retention.db, GRAPH).create("several", (INPUT, further), make_settings(), "")
    assert "2" * 64 in retention.inputs_in_use()
    assert "2" * 64 in retention.inputs_at_work()
    Inspections(retention.db, GRAPH).reopen("several", FILES, make_settings())
    assert "2" * 64 not in retention.inputs_in_use()
    Inspections(retention.db, GRAPH).reopen("several", (further, INPUT), make_settings())
    assert [one.video for one in Inspections(retention.db, GRAPH).get("several").files] == ["/w.mp4", "/v.mp4"]
