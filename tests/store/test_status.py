"""What inspections look like from outside, and their lists, on SQLite and PostgreSQL."""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime, timedelta
from typing import Any

import pytest
from sqlalchemy import event, select, update

from core.errors import BadInput
from core.products.front import FramesProduct
from core.settings import make_settings
from core.states import InspectionState
from store.account_models import DEFAULT_ACCOUNT
from store.db import Database
from store.inspections import Inspections, delete_results_from, mark_deleted
from store.listing import Filter, count_active, list_inspections
from store.models import Inspection, Task
from store.monitoring import count_all
from store.plan import Plan
from store.status import InspectionStatus, StageCount, Statuses, plan_share
from store.timings import Expectation, StageTiming, expected_frames, learn_timings, plan_eta, stage_eta
from tests.core.making_products import facts_of
from tests.store.small_plan import FILES, GRAPH, result_for


def create(db: Database, name: str, **more: Any) -> None:
    with db.write() as session:
        Inspections(db, GRAPH).create_in(session, name, FILES, make_settings(), "", **more)


def work(db: Database, name: str, tasks: int = 1000) -> None:
    plan = Plan(db, GRAPH)
    for _ in range(tasks):
        lease = plan.lease("me", inspection_id=name)
        if lease is None:
            return
        assert plan.complete(lease, result_for(lease))


def publish(db: Database, name: str) -> None:
    with db.write() as session:
        session.execute(update(Inspection).where(Inspection.id == name).values(published=Inspection.attempt))


def status(db: Database, name: str) -> InspectionStatus:
    found = Statuses(db, GRAPH).read(name)
    assert found is not None
    return found


def test_an_inspection_is_over_once_it_is_published(db: Database) -> None:
    create(db, "one")
    assert (status(db, "one").state, status(db, "one").stage, status(db, "one").queue_position) == (
        "queued",
        "split",
        1,
    )
    work(db, "one")
    assert (status(db, "one").state, status(db, "one").stage) == ("running", "publish")
    assert status(db, "one").progress < 1
    publish(db, "one")
    assert (status(db, "one").state, status(db, "one").stage, status(db, "one").progress) == ("succeeded", None, 1.0)
    assert Statuses(db, GRAPH).read("two") is None


def test_a_cancelled_one_is_cancelling_until_what_it_reached_is_published(db: Database) -> None:
    create(db, "one")
    Plan(db, GRAPH).cancel("one")
    assert status(db, "one").state == "cancelling"
    publish(db, "one")
    assert status(db, "one").state == "cancelled"


def test_a_page_says_the_same_as_single_reads(db: Database) -> None:
    create(db, "one")
    work(db, "one", 2)
    create(db, "two", label="x")
    page = list_inspections(db, Filter(DEFAULT_ACCOUNT), 10, None)
    found = Statuses(db, GRAPH).read_many(page.rows)
    assert [each.row.id for each in found] == ["two", "one"]
    for each in found:
        single = status(db, each.row.id)
        assert (each.state, each.stages, each.progress) == (single.state, single.stages, single.progress)


def test_pages_cover_everything_once_even_at_equal_times(db: Database) -> None:
    names = [f"{number:02d}" for number in range(7)]
    for name in names:
        create(db, name)
    with db.write() as session:
        session.execute(update(Inspection).values(created_at=datetime(2026, 5, 4, tzinfo=UTC)))
    seen: list[str] = []
    cursor: str | None = None
    while True:
        page = list_inspections(db, Filter(DEFAULT_ACCOUNT), 3, cursor)
        seen += [row.id for row in page.rows]
        if (cursor := page.cursor) is None:
            break
    assert seen == names[::-1]
    for wrong in ("", "x", "W10", "WyJ4IiwieSJd"):
        with pytest.raises(BadInput):
            list_inspections(db, Filter(DEFAULT_ACCOUNT), 3, wrong)


def test_deleted_ones_and_those_of_others_are_not_listed(db: Database) -> None:
    for name, owner in (("mine", "me"), ("gone", "me"), ("theirs", "you")):
        create(db, name, owner=owner)
    assert mark_deleted(db, "gone")
    assert not mark_deleted(db, "gone")
    assert [row.id for row in list_inspections(db, Filter("me"), 10, None).rows] == ["mine"]
    assert count_active(db) == 3


def test_counts_of_everything(db: Database) -> None:
    create(db, "one")
    with db.write() as session:
        earlier = db.now(session) - timedelta(seconds=100)
        session.execute(update(Inspection).values(created_at=earlier))
    counts = count_all(db)
    assert (counts.inspections, counts.tasks, counts.uploads) == ({"queued": 1}, {("cpu", "runnable"): 1}, 0)
    assert 99 < counts.oldest_queued_s < 160
    work(db, "one", 1)
    assert count_all(db).attempts == {"succeeded": 1}


def test_progress_weighs_stages_and_passes_over_what_never_came() -> None:
    assert plan_share(GRAPH, {}) == 0.0
    half = {"split": StageCount(1, 1), "part": StageCount(4, 1, running=1.0)}
    assert plan_share(GRAPH, half) == pytest.approx(1.5 / 4, abs=0.005)
    assert plan_share(GRAPH, {name: StageCount(2, 2) for name in GRAPH.stages}) == 1.0
    assert plan_share(GRAPH, {"last": StageCount(1, 1)}) == 1.0


def test_timings_are_learnt_from_inspections_that_came_to_an_end(db: Database) -> None:
    create(db, "one")
    work(db, "one", 3)
    assert learn_timings(db) == {}
    work(db, "one")
    with db.write() as session:  # as if they had taken no longer than their stages
        session.execute(update(Task).values(started_at=Task.ended_at))
    learnt = learn_timings(db)
    assert set(learnt) == set(GRAPH.stages)
    assert learnt["part"].per_task == (0.75, 3.0), "one sample says little"
    assert learnt["part"].per_plan == (2.25, 9.0)
    with db.write() as session:
        Inspections(db, GRAPH).create_in(session, "two", FILES, make_settings(options={"matching.window": 9}), "")
        join = session.scalars(select(Task).where(Task.inspection_id == "one", Task.stage == "join")).one()
        assert join.ended_at is not None
        join.started_at = join.ended_at - timedelta(seconds=9)
    assert learn_timings(db)["join"].per_task == (4.5, 18.0), "its process and its files take time too"
    fresh = status(db, "two").stages
    alone = Expectation(GRAPH, learnt, 1, (96, 96))
    assert plan_eta(fresh, alone) == (round(4.5 * 0.7, 1), 18.0 * 1.4 + 5.0)
    assert plan_eta(fresh, replace(alone, workers=2))[0] < 3.1


def test_what_was_never_done_before_is_guessed_from_its_weight(db: Database) -> None:
    create(db, "one")
    stages = status(db, "one").stages
    weights = sum(spec.weight for spec in GRAPH.stages.values())
    usual = Expectation(GRAPH, {}, 2, (96, 96))
    assert plan_eta(stages, usual) == pytest.approx((weights * 0.4 * 0.7, weights * 2.5 * 1.4 + 5.0), abs=0.1)
    part = next(stage for stage in stages if stage.name == "part")
    assert stage_eta(part, usual) == (0.4, 2.5)
    assert stage_eta(part, replace(usual, workers=4)) == (0.2, 1.2), "it fans out"
    growing = replace(GRAPH, stages={**GRAPH.stages, "part": replace(GRAPH.stages["part"], per_frame=True)})
    assert stage_eta(part, replace(usual, graph=growing, frames=(24, 480))) == (0.1, 12.5)
    learnt = {"split": StageTiming((1, 2), (1, 2))}
    assert stage_eta(part, replace(usual, timings=learnt)) == (0.0, 2.5), "the others had none of it"


def test_frames_are_bounded_by_the_settings_until_they_are_counted(db: Database) -> None:
    create(db, "one")
    with db.write() as session:
        row = session.get_one(Inspection, "one")
        row.settings = {**row.settings, "frames": {**row.settings["frames"], "max_count": 300}}
    assert expected_frames(db, row) == (24, 300)
    with db.write() as session:
        session.execute(update(Task).values(key="frames", facts=facts_of(FramesProduct, n_frames=96)))
    assert expected_frames(db, row) == (96, 96)


def test_frames_of_an_inspection_that_is_over_are_not_asked_for(db: Database) -> None:
    create(db, "one")
    with db.read() as session:
        row = session.get_one(Inspection, "one")
    asked: list[InspectionState] = []

    def note(*_: object) -> None:
        asked.append(row.state)

    event.listen(db.engine, "before_cursor_execute", note)
    for state in (InspectionState.RUNNING, InspectionState.FAILED, InspectionState.SUCCEEDED):
        row.state = state
        assert expected_frames(db, row)[0] == 24
    event.remove(db.engine, "before_cursor_execute", note)
    assert set(asked) == {InspectionState.RUNNING}


def test_deleting_takes_the_stage_and_all_that_follow(db: Database) -> None:
    create(db, "one")
    work(db, "one")
    inspections = Inspections(db, GRAPH)
    paths = delete_results_from(inspections, "one", "join")
    assert sorted(path.split("/")[0] for path in paths) == ["join", "last"]
    assert {path.split("/")[0] for path in inspections.known_results().values()} == {"split", "part"}
    inspections.reopen("one", FILES, make_settings(), ended_only=True, label="again")
    row = status(db, "one").row
    assert (row.attempt, row.label, row.progress) == (2, "again", 0.0)
    with pytest.raises(BadInput) as caught:
        inspections.reopen("one", FILES, make_settings(), ended_only=True)
    assert caught.value.code == "conflict"
