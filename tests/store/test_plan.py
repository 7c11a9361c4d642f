"""Leases, fences and what follows from results, on SQLite and PostgreSQL."""

from __future__ import annotations

import threading
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from datetime import timedelta

import pytest
from sqlalchemy import delete, select, update

from core.errors import BadInput, ResourceError, StageFailed
from core.settings import make_settings
from core.states import TaskState
from store.db import Database
from store.inspections import Inspections
from store.leasing import put_result
from store.models import Attempt, CaseRow, DetectionRow, MetricRow, Result, Task
from store.plan import Plan
from store.records import Lease
from store.records import Result as FinishedResult
from tests.store.small_plan import FILES, GRAPH, INPUT, result_for

ID = "one"


@pytest.fixture
def plan(db: Database) -> Plan:
    Inspections(db, GRAPH).create(ID, FILES, make_settings(), "/out")
    return Plan(db, GRAPH)


def inspections(plan: Plan) -> Inspections:
    return Inspections(plan.db, GRAPH)


def take(plan: Plan, key: str, owner: str = "me") -> Lease:
    lease = plan.lease(owner)
    assert lease is not None
    assert lease.key == key
    return lease


def finish(plan: Plan, key: str) -> None:
    lease = take(plan, key)
    assert plan.complete(lease, result_for(lease))


def finish_all(plan: Plan) -> list[str]:
    done = []
    while (lease := plan.lease("me")) is not None:
        assert plan.complete(lease, result_for(lease))
        done.append(lease.key)
    return done


def states(plan: Plan) -> dict[str, str]:
    return {task.key: task.state for task in inspections(plan).tasks(ID)}


def outcomes(plan: Plan) -> list[tuple[str, str]]:
    with plan.db.read() as session:
        return [(row.key, row.outcome) for row in session.scalars(select(Attempt).order_by(Attempt.id))]


def run_out(plan: Plan) -> None:
    """Let every lease be over."""
    with plan.db.write() as session:
        past = plan.db.now(session) - timedelta(seconds=1)
        session.execute(update(Task).where(Task.state == "leased").values(lease_expires_at=past))


def test_a_plan_unfolds_as_facts_come_in_and_ends_succeeded(plan: Plan) -> None:
    assert states(plan) == {"split": "runnable"}
    finish(plan, "split")
    expected = {"split": "succeeded", "part/0": "runnable", "part/1": "runnable", "part/2": "runnable"}
    assert states(plan) == {**expected, "join": "waiting", "last": "waiting"}
    assert finish_all(plan) == ["part/0", "part/1", "part/2", "join", "last"]
    assert inspections(plan).get(ID).state == "succeeded"


def test_a_lease_carries_results_and_facts_of_its_dependencies(plan: Plan) -> None:
    finish(plan, "split")
    lease = take(plan, "part/0")
    assert lease.facts == {"split": {"n": 3}}
    assert list(lease.inputs) == ["split"]
    assert lease.inputs["split"].parts[0] == "split"
    assert (lease.args, lease.attempt, lease.fence) == ({"i": 0}, 1, 1)


def test_a_second_completion_is_refused(plan: Plan) -> None:
    lease = take(plan, "split")
    assert plan.complete(lease, result_for(lease))
    assert not plan.complete(lease, result_for(lease, {"n": 7}))
    assert [task.facts for task in inspections(plan).tasks(ID) if task.key == "split"] == [{"n": 3}]


def test_the_result_of_an_expired_lease_is_refused_and_the_next_one_counts(plan: Plan) -> None:
    late = take(plan, "split", "slow")
    run_out(plan)
    assert plan.expire() == 1
    lease = take(plan, "split", "fast")
    assert (lease.fence, lease.attempt) == (2, 2)
    assert plan.heartbeat([(late, 0.5, ""), (lease, 0.1, "")]) == [late]
    assert not plan.complete(late, result_for(late, {"n": 9}))
    assert plan.fail(late, StageFailed("late").to_dict(), retry=False) == "refused"
    assert not plan.release(late)
    assert plan.complete(lease, result_for(lease))
    assert [outcome for _, outcome in outcomes(plan)] == ["refused", "succeeded"]
    assert states(plan)["part/0"] == "runnable"


def test_heartbeats_keep_a_lease_and_the_sweeper_leaves_it_alone(plan: Plan) -> None:
    lease = take(plan, "split")
    run_out(plan)
    assert plan.heartbeat([(lease, 0.25, "half way")]) == []
    assert plan.expire() == 0
    assert [task.progress for task in inspections(plan).tasks(ID)] == [0.25]


def test_a_task_that_loses_its_worker_three_times_has_failed(plan: Plan) -> None:
    for _ in range(3):
        take(plan, "split")
        run_out(plan)
        assert plan.expire() == 1
    assert plan.lease("me") is None
    view = inspections(plan).get(ID)
    assert (view.state, view.failed_stage, (view.error or {})["code"]) == ("failed", "split", "worker_lost")
    assert (view.error or {})["retryable"] is False, "it has been tried three times"


def test_retries_end_after_three_attempts_and_an_optional_task_is_then_done_without(plan: Plan) -> None:
    finish(plan, "split")
    error = ResourceError("no memory", code="oom").to_dict()
    answers = [plan.fail(take(plan, "part/0"), error, retry=True) for _ in range(3)]
    assert answers == ["retried", "retried", "failed"]
    finish(plan, "part/1")
    finish(plan, "part/2")
    lease = take(plan, "join")
    assert sorted(lease.inputs) == ["part/1", "part/2", "split"]
    assert plan.complete(lease, result_for(lease))
    finish(plan, "last")
    assert inspections(plan).get(ID).state == "succeeded"


def test_what_stops_the_run_is_not_tolerated_in_an_optional_task(plan: Plan) -> None:
    finish(plan, "split")
    record = {**StageFailed("disk", code="disk_full").to_dict(), "stops_run": True}
    assert plan.fail(take(plan, "part/0"), record, retry=False) == "failed"
    assert states(plan)["join"] == "skipped"
    assert inspections(plan).get(ID).state == "failed"


def test_a_failure_skips_what_depends_on_it_and_lets_running_tasks_finish(plan: Plan) -> None:
    finish(plan, "split")
    for _ in range(3):
        finish(plan, plan_next(plan))
    lease = take(plan, "join")
    assert plan.fail(lease, StageFailed("no surface").to_dict(), retry=False) == "failed"
    assert states(plan)["last"] == "skipped"
    view = inspections(plan).get(ID)
    assert (view.state, view.failed_stage) == ("failed", "join")
    assert (view.error or {})["message"] == "no surface"


def plan_next(plan: Plan) -> str:
    return next(key for key, state in states(plan).items() if state == "runnable")


def test_a_failure_after_there_is_something_to_serve_is_partial(plan: Plan) -> None:
    for key in ("split", "part/0", "part/1", "part/2", "join"):
        finish(plan, key)
    plan.fail(take(plan, "last"), StageFailed("x").to_dict(), retry=False)
    assert inspections(plan).get(ID).state == "partial"


def test_no_reconstruction_is_failed_even_late(plan: Plan) -> None:
    for key in ("split", "part/0", "part/1", "part/2", "join"):
        finish(plan, key)
    plan.fail(take(plan, "last"), StageFailed("x", code="no_reconstruction").to_dict(), retry=False)
    assert inspections(plan).get(ID).state == "failed"


def test_a_released_task_starts_again_and_its_attempt_does_not_count(plan: Plan) -> None:
    assert plan.release(take(plan, "split"))
    lease = take(plan, "split")
    assert (lease.attempt, lease.fence) == (1, 2)


def test_a_restarted_owner_takes_over_its_leases_at_once(plan: Plan) -> None:
    take(plan, "split", "host-a/1")
    assert plan.take_over(ID, owner_prefix="host-b") == 0
    assert plan.take_over(ID, owner_prefix="host-a") == 1
    assert take(plan, "split").attempt == 1


def test_a_server_that_starts_again_takes_over_its_own_leases_of_every_inspection(plan: Plan) -> None:
    take(plan, "split", owner="server-a/1")
    assert plan.take_over_all("server-b/") == 0
    assert plan.take_over_all("server-a/") == 1
    assert take(plan, "split", owner="server-b/1").owner == "server-b/1"


def test_cancel_waits_for_running_tasks_and_starts_nothing(plan: Plan) -> None:
    finish(plan, "split")
    lease = take(plan, "part/0")
    assert plan.cancel(ID) == "cancelling"
    assert plan.cancelling([ID]) == {ID}
    assert plan.lease("me") is None
    assert plan.release(lease)
    assert inspections(plan).get(ID).state == "cancelled"
    assert states(plan)["part/0"] == "cancelled"
    with plan.db.read() as session:
        tasks = session.scalars(select(Task).where(Task.state == TaskState.CANCELLED)).all()
        assert len(tasks) > 1
        assert all(task.ended_at is not None for task in tasks), "those that never began, too"


def test_reopening_reuses_every_finished_result(plan: Plan) -> None:
    finish_all(plan)
    inspections(plan).reopen(ID, FILES, make_settings())
    assert plan.lease("me") is None
    assert inspections(plan).get(ID).state == "succeeded"
    assert all(task.reused for task in inspections(plan).tasks(ID))


@pytest.mark.parametrize(
    ("option", "again"),
    [
        ({"timeline.radius_fraction": 0.05}, ["last"]),
        ({"mesh.poisson_trim": 5.0}, ["join"]),  # its result is the same, so what follows stands
        ({"mapper.min_model_size": 4}, ["part/0", "part/1", "part/2"]),
        ({"dense.views": 7}, []),
    ],
)
def test_changed_parameters_recompute_only_what_they_touch(
    plan: Plan, option: dict[str, float], again: list[str]
) -> None:
    finish_all(plan)
    inspections(plan).reopen(ID, FILES, make_settings(options=option))
    assert finish_all(plan) == again
    inspections(plan).reopen(ID, FILES, make_settings())
    assert finish_all(plan) == []


def test_other_annotations_touch_only_the_stage_that_reads_them(plan: Plan) -> None:
    finish_all(plan)
    inspections(plan).reopen(ID, [replace(INPUT, annotations=None, annotations_sha256=None)], make_settings())
    assert finish_all(plan) == ["last"]


def test_reopening_gives_failed_tasks_a_new_chance_and_drops_old_tasks(plan: Plan) -> None:
    lease = take(plan, "split")
    plan.complete(lease, result_for(lease, {"n": 1}))
    plan.fail(take(plan, "part/0"), StageFailed("x").to_dict(), retry=False)
    inspections(plan).reopen(ID, FILES, make_settings(options={"matching.window": 8}))
    assert finish_all(plan) == ["split", "part/0", "part/1", "part/2", "join", "last"]


def test_reopening_is_refused_while_a_task_is_leased(plan: Plan) -> None:
    take(plan, "split")
    with pytest.raises(BadInput) as caught:
        inspections(plan).reopen(ID, FILES, make_settings())
    assert caught.value.code == "conflict"


def test_a_result_of_a_rebuilt_plan_is_refused(plan: Plan) -> None:
    old = take(plan, "split")
    plan.take_over(ID)
    inspections(plan).reopen(ID, FILES, make_settings())
    new = take(plan, "split")
    assert not plan.complete(old, result_for(old, {"n": 9}))
    assert plan.complete(new, result_for(new))


def test_only_results_of_this_and_the_previous_parameters_are_kept(plan: Plan) -> None:
    finish_all(plan)
    for trim in (5.0, 6.0, 7.0):
        inspections(plan).reopen(ID, FILES, make_settings(options={"mesh.poisson_trim": trim}))
        finish_all(plan)
    known = inspections(plan).known_results()
    assert len(known) == 5 + 3  # the default trim is 6.0: its result was there
    unused = inspections(plan).unused()
    assert [known[name].split("/")[0] for name in unused] == ["join"]
    inspections(plan).delete_results(unused)
    assert inspections(plan).unused() == []


def test_deleting_from_a_stage_names_all_that_follow(plan: Plan) -> None:
    finish_all(plan)
    assert inspections(plan).stages_from(ID, "join") == {"join", "last"}
    assert inspections(plan).stages_from(ID, "part") == {"part", "join", "last"}


def test_rows_are_written_with_the_task_that_made_them_and_come_along_when_reused(plan: Plan) -> None:
    finish(plan, "split")
    case = {
        "name": "seg_000_0000_0002",
        "kind": "coarse",
        "start": 0,
        "end": 2,
        "status": "succeeded",
        "reason": "",
        "frames": 2,
        "models": 1,
        "registered_images": 2,
        "points3D": 50,
        "mean_reprojection_error_px": 0.5,
        "median_reprojection_error_px": 0.4,
        "start_mode": "scratch",
    }
    lease = take(plan, "part/0")
    rows = {
        "cases": [case],
        "metrics": [{"name": "points3D", "value": 50.0}],
        "detections": [detection(0), detection(1)],
    }
    plan.complete(lease, result_for(lease, rows=rows))
    lease = take(plan, "part/1")
    plan.complete(lease, result_for(lease, rows={"detections": [detection(0)]}))
    for _ in range(2):
        with plan.db.read() as session:
            columns = CaseRow.__table__.c
            of_case = select(columns.points3D, columns.seconds, columns.selected, columns.vetoed)
            assert session.execute(of_case).all() == [(50, 1.5, 0, 0)]  # until the reducer chooses
            assert [row.name for row in session.scalars(select(MetricRow))] == ["part/0.points3D"]
            assert [(row.id, row.task_key) for row in session.scalars(select(DetectionRow))] == [(0, "part/1")]
        inspections(plan).reopen(ID, FILES, make_settings())


def detection(number: int) -> dict[str, object]:
    box = dict.fromkeys(("box_x1", "box_y1", "box_x2", "box_y2"), 0.5)
    empty = dict.fromkeys(("frame_index", "rung", "support_points", "x", "y", "z", "confidence", "blade", "defect_id"))
    named = {"id": number, "key": "00:01", "time_s": 1.0, "label": "dent", "score": None, "model": None}
    return {**named, **box, **empty, "outcome": "unplaced", "reason": "no_frame", "own_extra": 1}


def test_a_failed_transaction_leaves_nothing_behind(plan: Plan) -> None:
    lease = take(plan, "split")
    broken = result_for(lease, rows={"detections": [{"id": 0}]})
    with pytest.raises(Exception, match="detections"):
        plan.complete(lease, broken)
    assert inspections(plan).known_results() == {}
    assert plan.complete(lease, result_for(lease))


def test_results_that_vanished_are_made_anew_and_the_plan_goes_on(plan: Plan) -> None:
    for key in ("split", "part/0", "part/1"):
        finish(plan, key)
    with plan.db.write() as session:
        session.execute(delete(Result))
    assert plan.lease("me") is None
    assert states(plan) == {"split": "runnable", "part/0": "succeeded", "part/1": "succeeded", "part/2": "waiting"} | {
        "join": "waiting",
        "last": "waiting",
    }
    finish(plan, "split")
    finish(plan, "part/2")
    assert plan.lease("me") is None
    finish(plan, "part/0")
    finish(plan, "part/1")
    lease = take(plan, "join")
    # The rows are there, but the runner found the files of one gone.
    assert plan.remake(lease, ["part/2"])
    assert not plan.remake(lease, ["part/2"])
    assert finish_all(plan) == ["part/2", "join", "last"]
    assert inspections(plan).get(ID).state == "succeeded"


def test_an_unknown_inspection_is_said(plan: Plan) -> None:
    with pytest.raises(BadInput):
        inspections(plan).get("nobody")


def test_two_inspections_finish_the_same_result_at_the_same_moment(db: Database) -> None:
    """The second one is at its insert while the first has not committed."""
    result = FinishedResult("f" * 64, "split", "d" * 64, {}, "split/f", 1.0, 1)
    inserting = threading.Event()

    def second() -> None:
        inserting.set()
        with db.write() as session:
            put_result(session, replace(result, seconds=2.0), db.now(session))

    with ThreadPoolExecutor(1) as pool:
        with db.write() as session:
            put_result(session, result, db.now(session))
            session.flush()
            waiting = pool.submit(second)
            inserting.wait(10.0)
            time.sleep(0.3)
            assert not waiting.done()
        waiting.result(10.0)
    with db.read() as session:
        assert session.get_one(Result, result.fingerprint).seconds == 2.0
