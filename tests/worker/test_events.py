"""Progress of a run from its plan."""

from __future__ import annotations

from dataclasses import replace

import pytest

from core.states import TaskState
from store.records import TaskView
from tests.worker.fake_stages import GRAPH
from worker.events import EventKind, Tracker


def view(key: str, state: str, seconds: float | None = None) -> TaskView:
    return TaskView(
        key=key,
        stage=key.split("/")[0],
        position=0,
        depends=(),
        optional=False,
        state=TaskState(state),
        attempt=1,
        fingerprint=None,
        seconds=seconds,
        peak_rss_bytes=None,
        progress=0.0,
        reused=False,
        digest=None,
        facts=None,
        error=None,
        path=None,
    )


PLAN = [view("split", "succeeded", 2.0), view("part/000", "leased"), view("part/001", "runnable")]
"""Weights: split 1, part 10, join 1, last 1."""


def test_the_fraction_weighs_stages_and_counts_running_tasks() -> None:
    tracker = Tracker(GRAPH, workers=1)
    tracker.refresh(PLAN)
    assert tracker.event(EventKind.PROGRESS, "part/000").fraction == pytest.approx(1 / 13)
    tracker.running("part/000", 0.5)
    event = tracker.event(EventKind.PROGRESS, "part/000")
    assert event.fraction == pytest.approx((1 + 10 * 0.25) / 13)
    assert (event.stage, event.done, event.total, event.stage_fraction) == ("part", 0, 2, 0.25)


def test_the_fraction_never_falls_when_a_task_starts_again() -> None:
    tracker = Tracker(GRAPH, workers=1)
    tracker.refresh(PLAN)
    tracker.running("part/000", 0.8)
    high = tracker.event(EventKind.PROGRESS, "part/000").fraction
    tracker.idle("part/000")
    assert tracker.event(EventKind.RETRY, "part/000").fraction == high


def test_a_stage_without_tasks_that_was_passed_has_no_weight() -> None:
    tracker = Tracker(GRAPH, workers=1)
    tracker.refresh([view("split", "succeeded", 1.0), view("join", "succeeded", 1.0), view("last", "runnable")])
    assert tracker.event(EventKind.STARTED, "last").fraction == pytest.approx(2 / 3)


def test_the_time_left_follows_from_what_tasks_took() -> None:
    tracker = Tracker(GRAPH, workers=2)
    assert tracker.event(EventKind.OPENED).eta_s is None
    done = [PLAN[0], view("part/000", "succeeded", 30.0), PLAN[2]]
    tracker.refresh(done)
    # One part of 30 s by two workers, and two stages of weight 1 at (2 + 30 / 2) s per 6 done units of weight.
    assert tracker.event(EventKind.PROGRESS).eta_s == pytest.approx(15 + 2 * 17 / 6, abs=0.1)


def test_refreshing_tells_what_ended_since() -> None:
    tracker = Tracker(GRAPH, workers=1)
    assert [event.key for event in tracker.refresh(PLAN)] == ["split"]
    failed = replace(view("part/001", "failed"), error={"message": "no surface"})
    events = tracker.refresh([*PLAN[:2], failed])
    assert [(event.key, event.state, event.message) for event in events] == [("part/001", "failed", "no surface")]
    assert tracker.refresh([*PLAN[:2], failed]) == []


def test_a_task_of_a_further_model_counts_for_its_stage() -> None:
    tracker = Tracker(GRAPH, workers=1)
    tracker.refresh([view("split", "succeeded", 1.0), view("join", "succeeded", 1.0)])
    event = tracker.event(EventKind.STARTED, "join@1")
    assert (event.stage, event.done, event.total) == ("join", 1, 1)
