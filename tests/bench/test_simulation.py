"""The simulation: what follows from a plan is in closed form, and a real run is met."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import pytest
from sqlalchemy import URL

from bench.service import simulate as command
from bench.service.recording import RecordedTask, Recording, read_recording, record
from bench.service.simulation import Simulated, Workload, simulate
from bench.soak.toy import GRAPH
from bench.speed.timing import Table
from core.errors import BadInput, StageFailed
from core.settings import make_settings
from store.db import Database, upgrade
from store.inspections import Inspections
from store.plan import Plan
from store.records import InputFiles, Result
from tests.databases import BOTH, database_url, put_new_tables

pytestmark = pytest.mark.slow

SPLIT, PART, JOIN, CONFIRM = 10.0, 20.0, 5.0, 1.0
ALONE = SPLIT + 4 * PART + JOIN + CONFIRM


TOY = Recording(
    make_settings().model_dump(mode="json"),
    {
        "split": RecordedTask(SPLIT, SPLIT, 1, {"n": 4}),
        **{f"part/{i:03d}": RecordedTask(PART, PART, 1, {}) for i in range(4)},
        "join": RecordedTask(JOIN, JOIN, 1, {}),
        "confirm": RecordedTask(CONFIRM, CONFIRM, 1, {}),
    },
    0.0,
)


@pytest.fixture(params=BOTH)
def url(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[URL]:
    with database_url(request.param, tmp_path) as made:
        if request.param == "sqlite":
            put_new_tables(tmp_path / "plan.db")
        else:
            upgrade(made)
        yield made


def run(url: URL, load: Workload, recording: Recording = TOY) -> Simulated:
    return simulate(url, GRAPH, [recording], load)


def test_one_worker_does_one_thing_after_the_other(url: URL) -> None:
    found = run(url, Workload(2, 0.0, 1))
    assert found.end_s == pytest.approx(2 * ALONE)
    assert found.busy_s == pytest.approx(2 * ALONE)
    assert sorted(found.queue_s)[0] == 0.0
    assert len(found.costs_s["lease"]) == len(found.costs_s["complete"]) == 2 * len(TOY.tasks)


def test_parts_run_side_by_side(url: URL) -> None:
    found = run(url, Workload(1, 0.0, 4))
    assert found.whole_s == [pytest.approx(SPLIT + PART + JOIN + CONFIRM)]
    assert found.most_waiting == 0


def test_stretch_and_handover_cost_what_they_say(url: URL) -> None:
    slow = replace(
        TOY, handover_s=2.0, tasks={key: replace(one, slot_s=one.slot_s + 3) for key, one in TOY.tasks.items()}
    )
    found = run(url, Workload(1, 0.0, 1, stretch=2.0), slow)
    # Outside the stage nothing is stretched; the last handover is after the end.
    assert found.end_s == pytest.approx(2 * ALONE + 7 * 3.0 + 6 * 2.0)


def test_inspections_come_when_they_are_told_to(url: URL) -> None:
    found = run(url, Workload(2, 0.0, 1, arrivals_s=(5.0, 5.0 + 3 * ALONE)))
    assert found.end_s == pytest.approx(5.0 + 4 * ALONE)
    assert found.queue_s == [0.0, 0.0]


def test_more_than_there_is_room_for_waits(url: URL) -> None:
    half = run(url, Workload(20, 20 * ALONE, 2, accounts=3, seed=1))
    assert half.busy_s / (2 * half.end_s) < 0.6
    assert max(half.queue_s) < 3 * ALONE


def test_a_queue_grows_when_slots_are_full(tmp_path: Path) -> None:
    with database_url("sqlite", tmp_path) as made:
        put_new_tables(tmp_path / "plan.db")
        found = run(made, Workload(12, ALONE, 1))
    assert max(found.queue_s) > 5 * ALONE
    assert found.most_waiting > 5


def without(*keys: str) -> Recording:
    return replace(TOY, tasks={key: one for key, one in TOY.tasks.items() if key not in keys})


def test_a_task_that_was_not_recorded_ends_the_simulation(tmp_path: Path) -> None:
    with database_url("sqlite", tmp_path) as made:
        put_new_tables(tmp_path / "plan.db")
        with pytest.raises(StageFailed, match="no task 'part/002'"):
            run(made, Workload(1, 0.0, 1), without("part/002"))


def test_a_stage_newer_than_the_recording_is_named_and_takes_no_time(tmp_path: Path) -> None:
    with database_url("sqlite", tmp_path) as made:
        put_new_tables(tmp_path / "plan.db")
        found = run(made, Workload(1, 0.0, 1), without("confirm"))
    assert found.unknown == {"confirm"}
    assert found.end_s == pytest.approx(ALONE - CONFIRM)


def test_a_recording_is_what_the_database_says(tmp_path: Path) -> None:
    put_new_tables(tmp_path / "plan.db")
    with closing(Database(f"sqlite:///{tmp_path / 'plan.db'}")) as db:
        inspections, plan = Inspections(db, GRAPH), Plan(db, GRAPH)
        for name in ("one", "again"):  # the second one takes up all results of the first
            inspections.create(name, [InputFiles("video", "0" * 64, None, None)], make_settings(), "")
            while (lease := plan.lease("slot", inspection_id=name)) is not None:
                facts = {"n": 4} if lease.key == "split" else {}
                assert plan.complete(lease, Result(lease.fingerprint, lease.stage, lease.key, facts, "r", 1.5, 7))
        found = record(db)
    assert len(found) == 1
    assert set(found[0].tasks) == set(TOY.tasks)
    assert found[0].tasks["split"].facts == {"n": 4}
    assert {one.stage_s for one in found[0].tasks.values()} == {1.5}
    assert all(0 < one.slot_s < 5 for one in found[0].tasks.values())
    assert 0 < found[0].handover_s < 0.5
    found[0].write(tmp_path / "recording.json")
    assert read_recording(tmp_path / "recording.json") == found[0]
    (tmp_path / "other.json").write_text("[]", encoding="utf-8")
    with pytest.raises(BadInput, match="is no recording"):
        read_recording(tmp_path / "other.json")


def values(table: Table) -> dict[str, float]:
    return {row.name: float(row.value) for row in table.rows if isinstance(row.value, int | float)}


def test_the_sample_runs_from_its_recording(tmp_path: Path) -> None:
    recording = read_recording(command.RECORDED)
    url = command._sqlite(tmp_path / "plan.db")
    found = values(command.day(url, recording, Workload(1, 0.0, 2)))
    assert found["tasks of an inspection"] == len(recording.tasks) > 30
    # On two slots the tasks of one inspection overlap, and do not fill both.
    slot_s = found["seconds of a slot for an inspection"]
    assert slot_s / 2 < found["from arrival to end, median"] < slot_s


@pytest.mark.deployment
@pytest.mark.long
def test_a_real_run_of_two_workers_is_met(tmp_path: Path) -> None:
    found = values(command.calibration(tmp_path, "toy", 4))
    for what in ("the last end", "mean time of a job"):
        assert abs(found[f"{what}, replayed: off by"]) < 15, found
        # What one job took says less about others: tests share the cores with whatever else runs.
        assert 0.3 < found[f"{what}, predicted"] / found[f"{what}, real"] < 3.0, found
