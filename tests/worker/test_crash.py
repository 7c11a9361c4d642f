"""kill -9 at any moment: nothing lives on, nothing finished is computed again, the result is the same."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

import psutil
import pytest
from sqlalchemy import select

from core.states import AttemptOutcome
from store.db import open_sqlite
from store.inspections import Inspections
from store.models import Attempt
from store.plan import Plan
from tests.signals import heed_interrupts
from tests.waiting import wait_for
from tests.worker.conftest import Workplace
from tests.worker.fake_stages import GRAPH, journal

pytestmark = pytest.mark.deployment
ROOT = Path(__file__).resolve().parents[2]
KILLS = int(os.environ.get("BLADEATLAS_TEST_KILLS", "4"))
"""Crashes of the random test; more of them in a long soak."""


def start(place: Workplace) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-m", "tests.worker.run_process", str(place.video), str(place.out)]
    return subprocess.Popen(command, cwd=ROOT, preexec_fn=heed_interrupts)


def pids(place: Workplace, what: str) -> list[int]:
    """Process ids that stages noted: of themselves (``start``) or of their helpers."""
    path = place.video.parent / "journal.txt"
    lines = [line.split() for line in path.read_text().splitlines()] if path.exists() else []
    return [int(line[1 if what == "helper" else 2]) for line in lines if line[0] == what]


def alive(pid: int) -> bool:
    try:
        return psutil.Process(pid).status() != psutil.STATUS_ZOMBIE
    except psutil.NoSuchProcess:
        return False


def test_killing_the_runner_kills_the_stage_and_its_helpers(place: Workplace) -> None:
    place.control(split={"helper": True, "sleep_s": 60, "deaf": True})
    runner = start(place)
    wait_for(lambda: bool(pids(place, "helper")))
    # Of the runner: the guard, the stage it guards, and what that started.
    family = [
        *pids(place, "start"),
        *pids(place, "helper"),
        *(p.pid for p in psutil.Process(runner.pid).children(True)),
    ]
    assert len(set(family)) == 3
    runner.kill()
    runner.wait()
    wait_for(lambda: not any(alive(pid) for pid in family), 3.0)


def test_killing_the_guard_or_the_stage_is_a_lost_worker_that_is_tried_again(place: Workplace) -> None:
    place.control(split={"sleep_s": 60, "times": 2, "deaf": True})
    runner = start(place)
    wait_for(lambda: len(pids(place, "start")) == 1)
    stage = psutil.Process(pids(place, "start")[0])
    guard = stage.parent()
    assert guard is not None
    guard.kill()
    wait_for(lambda: len(pids(place, "start")) == 2)
    assert not alive(stage.pid)
    os.kill(pids(place, "start")[1], signal.SIGKILL)
    assert runner.wait(60) == 0
    assert outcomes(place)[:3] == [("split", "retried"), ("split", "retried"), ("split", "succeeded")]


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupted_run_stops_cleanly_and_goes_on_later(place: Workplace, number: signal.Signals) -> None:
    place.control(part__000={"sleep_s": 60, "deaf": True}, part__001={"sleep_s": 60})
    runner = start(place)
    wait_for(lambda: len(pids(place, "start")) == 3)
    running = pids(place, "start")[1:]
    runner.send_signal(number)
    assert runner.wait(10) == 130
    assert not any(alive(pid) for pid in running)
    assert Counter(outcomes(place)) == {
        ("split", "succeeded"): 1,
        ("part/000", "released"): 1,
        ("part/001", "released"): 1,
    }
    assert place.temporary() == []
    place.control()
    place.started()
    assert place.run().state == "succeeded"
    assert "split" not in place.started()


def outcomes(place: Workplace) -> list[tuple[str, AttemptOutcome]]:
    database = open_sqlite(place.out / ".bladeatlas" / "plan.db")
    with database.read() as session:
        found = [(row.key, row.outcome) for row in session.scalars(select(Attempt).order_by(Attempt.id))]
    database.close()
    return found


def test_kill_at_random_moments_changes_nothing(place: Workplace, tmp_path: Path) -> None:
    undisturbed = Workplace(tmp_path / "undisturbed")
    undisturbed.video.parent.mkdir(parents=True)
    undisturbed.video.write_bytes(place.video.read_bytes())
    assert undisturbed.run().state == "succeeded"
    place.control(all={"sleep_s": 0.2})
    rng = random.Random(0)
    for _ in range(KILLS):
        runner = start(place)
        time.sleep(rng.uniform(0.3, 3.0))
        runner.kill()
        runner.wait()
        time.sleep(0.2)
    assert place.run().state == "succeeded"
    assert place.digests() == undisturbed.digests()
    assert published(place) == published(undisturbed)
    # A result that was sealed and renamed is adopted by the next start, so no stage ends twice: a kill before its row
    # is there leaves an attempt that was given back; only one before the rename makes the stage begin once more.
    ended = outcomes(place)
    accepted = Counter(key for key, outcome in ended if outcome == "succeeded")
    given_back = {key for key, outcome in ended if outcome == "released"}
    assert set(accepted) <= set(place.digests()) <= set(accepted) | given_back
    assert max(accepted.values()) == 1
    assert place.temporary() == []
    assert len(journal(place.video)) < 2 * (len(place.digests()) + 2 * KILLS)


def published(place: Workplace) -> list[str]:
    hidden = place.out / ".bladeatlas"
    return sorted(
        str(p.relative_to(place.out)) for p in place.out.rglob("*") if p.is_file() and hidden not in p.parents
    )


def test_a_result_whose_commit_was_cut_off_is_adopted(place: Workplace) -> None:
    place.run()
    place.started()
    database = open_sqlite(place.out / ".bladeatlas" / "plan.db")
    inspections = Inspections(database)
    inspections.delete_results(list(inspections.known_results())[:3])
    database.close()
    assert place.run().computed == 0
    assert place.started() == []


def test_a_frozen_runner_whose_lease_went_to_another_is_refused(place: Workplace) -> None:
    """SIGSTOP past the lease, and the sweeper of another process gives the task away."""
    place.control(split={"sleep_s": 1.5})
    runner = start(place)
    wait_for(lambda: bool(pids(place, "start")))
    runner.send_signal(signal.SIGSTOP)
    database = open_sqlite(place.out / ".bladeatlas" / "plan.db")
    plan = Plan(database, GRAPH)
    assert plan.take_over("local") == 1
    lease = plan.lease("another")
    assert lease is not None
    runner.send_signal(signal.SIGCONT)
    # Either the stage's result or the next heartbeat finds the lease gone; both are recorded as refused.
    wait_for(lambda: ("split", "refused") in outcomes(place))
    assert ("split", "succeeded") not in outcomes(place)
    assert plan.release(lease)
    database.close()
    assert runner.wait(60) == 0
    assert Counter(outcomes(place))[("split", AttemptOutcome.SUCCEEDED)] == 1
