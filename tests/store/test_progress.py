"""Progress follows time, and the time left holds the end, over the recorded run of the sample."""

from __future__ import annotations

import heapq
from collections import Counter
from pathlib import Path

import pytest

import bench.service
from bench.service.recording import Recording, read_recording
from core.products.contract import Facts
from core.settings import Settings
from core.states import StageState
from core.task_key import stage_of
from store.graph import CORE_GRAPH
from store.status import StageCount, StageStatus, plan_share
from store.timings import Expectation, plan_eta

RECORDED = Path(bench.service.__file__).with_name("recorded-default.json")
UNRECORDED_S = 1.0
"""Of a stage that is newer than the recording."""


def replay(recording: Recording, slots: int, *, told: bool) -> list[tuple[float, dict[str, StageCount]]]:
    """Seconds and the counts of every stage whenever a task ends; `told`: running tasks say how far they are."""
    settings, facts = Settings.model_validate(recording.settings), dict[str, Facts]()
    running: list[tuple[float, str, float]] = []
    """When it ends, which it is, when it began."""
    moment, found = 0.0, list[tuple[float, dict[str, StageCount]]]()
    while True:
        plan = CORE_GRAPH.expand(settings, facts)
        under_way = {key for _, key, _ in running}
        ready = [
            task.key
            for task in plan
            if task.key not in facts and task.key not in under_way and all(key in facts for key in task.depends)
        ]
        for key in ready[: slots - len(running)]:
            took = recording.tasks[key].slot_s if key in recording.tasks else UNRECORDED_S
            heapq.heappush(running, (moment + took, key, moment))
        total, over = Counter(task.stage for task in plan), Counter(stage_of(key) for key in facts)
        shares = dict.fromkeys(total, 0.0)
        for until, key, began in running:
            shares[stage_of(key)] += (moment - began) / (until - began) if told else 0.0
        found.append((moment, {stage: StageCount(total[stage], over[stage], shares[stage]) for stage in total}))
        if not running:
            return found
        moment, key, _ = heapq.heappop(running)
        facts[key] = dict(recording.tasks[key].facts) if key in recording.tasks else {}


@pytest.mark.parametrize("slots", [1, 2])
def test_no_tenth_of_progress_takes_a_quarter_of_the_time(slots: int) -> None:
    seen = replay(read_recording(RECORDED), slots, told=False)  # even if no task tells how far it is
    end = seen[-1][0]
    points = [(0.0, 0.0), *((moment, plan_share(CORE_GRAPH, counts)) for moment, counts in seen)]
    reached = [min(moment for moment, share in points if share >= tenth / 100) for tenth in range(101)]
    slowest = max(reached[i + 10] - reached[i] for i in range(91))
    assert slowest < 0.25 * end, (slowest / end, [round(when / end, 2) for when in reached[::10]])


@pytest.mark.parametrize("slots", [1, 2, 4])
def test_the_time_left_holds_the_end_from_the_first_task_on(slots: int) -> None:
    seen = replay(read_recording(RECORDED), slots, told=True)
    end = seen[-1][0]
    for moment, counts in seen[:-1]:
        stages = [shown(name, counts.get(name, StageCount(0, 0)), counts) for name in CORE_GRAPH.stages]
        counted = (96.0, 96.0) if moment > 10 else (24.0, 600.0)
        low, high = plan_eta(stages, Expectation(CORE_GRAPH, {}, slots, counted))
        assert low <= end - moment <= high, (moment, low, end - moment, high)


def shown(name: str, count: StageCount, counts: dict[str, StageCount]) -> StageStatus:
    names = list(CORE_GRAPH.stages)
    passed = not count.total and any(one in counts for one in names[names.index(name) + 1 :])
    ended = passed or (count.total and count.over == count.total)
    state = StageState.SUCCEEDED if ended else StageState.WAITING
    return StageStatus(name, state, count, 0, 0, None, None, 0.0, None)
