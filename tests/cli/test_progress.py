"""What is shown while a run goes."""

from __future__ import annotations

import io
import json

from rich.console import Console

from cli.progress import PLAIN_INTERVAL_S, JsonDisplay, LiveDisplay, PlainDisplay
from cli.terminal import duration
from worker.events import Event, EventKind

EVENTS = [
    Event(EventKind.OPENED, 0.0, total=4),
    Event(EventKind.STARTED, 0.0, stage="probe", key="probe", total=1),
    Event(EventKind.ENDED, 0.1, 50.0, "probe", "probe", "succeeded", 1, 1, 1.0, 2.5),
    Event(EventKind.ENDED, 0.4, 30.0, "coarse", "coarse/a", "failed", 1, 2, 0.5, 4.0),
    Event(EventKind.ENDED, 0.7, 10.0, "coarse", "coarse/b", "succeeded", 2, 2, 1.0, 4.0),
    Event(EventKind.RETRY, 0.7, 10.0, "fuse", "fuse", message="worker lost"),
    Event(EventKind.ENDED, 0.9, 1.0, "fuse", "fuse", "succeeded", 1, 1, 1.0, None, True),
    Event(EventKind.ENDED, 0.95, 1.0, "mesh", "mesh", "skipped", 1, 1, 1.0, 0.0),
    Event(EventKind.ENDED, 0.95, 1.0, "mesh", "mesh", "skipped", 1, 1, 1.0, 0.0),
    Event(EventKind.FINISHED, 1.0, state="succeeded"),
]


def test_plain_lines_say_each_stage_once() -> None:
    stream = io.StringIO()
    with PlainDisplay(stream, clock=lambda: 0.0) as display:
        for event in EVENTS:
            display.show(event)
    assert stream.getvalue().splitlines() == [
        "[ 10%] probe           2.5 s  (about 50.0 s left)",
        "[ 70%] coarse          2 tasks  8.0 s  1 without a result  (about 10.0 s left)",
        "[ 70%] fuse: trying again: worker lost  (about 10.0 s left)",
        "[ 90%] fuse            already there  (about 1.0 s left)",
        "[ 95%] mesh            skipped  (about 1.0 s left)",
    ]


def test_plain_lines_come_now_and_then_in_a_long_stage() -> None:
    stream, now = io.StringIO(), [0.0]
    display = PlainDisplay(stream, clock=lambda: now[0])
    for step in range(10):
        now[0] = step * PLAIN_INTERVAL_S / 3
        share = step / 10
        display.show(Event(EventKind.PROGRESS, share, 60.0, "features", "features/000", total=3, stage_fraction=share))
    assert stream.getvalue().splitlines() == [
        "[ 30%] features 30%  (about 1 min 00 s left)",
        "[ 60%] features 60%  (about 1 min 00 s left)",
        "[ 90%] features 90%  (about 1 min 00 s left)",
    ]


def test_json_lines() -> None:
    stream = io.StringIO()
    display = JsonDisplay(stream)
    for event in EVENTS:
        display.show(event)
    lines = [json.loads(line) for line in stream.getvalue().splitlines()]
    assert [line["event"] for line in lines] == [event.kind for event in EVENTS]
    assert lines[2]["stage"] == "probe"
    assert lines[2]["eta_s"] == 50.0


def test_live_display_ends_with_the_lines_of_the_stages() -> None:
    stream = io.StringIO()
    console = Console(file=stream, force_terminal=True, width=100, color_system=None)
    with LiveDisplay(console) as display:
        for event in EVENTS:
            display.show(event)
    assert "coarse          2 tasks  8.0 s  1 without a result" in stream.getvalue()


def test_durations() -> None:
    assert [duration(s) for s in (0.04, 59.94, 59.96, 185, 3599.7, 7620)] == [
        "0.0 s",
        "59.9 s",
        "1 min 00 s",
        "3 min 05 s",
        "1 h 00 min",
        "2 h 07 min",
    ]
