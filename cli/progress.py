"""How a run is shown while it goes: a live bar on a terminal, plain lines in a log, JSON lines for programs."""

from __future__ import annotations

import sys
import time
from collections import Counter, defaultdict
from collections.abc import Callable
from dataclasses import asdict
from types import TracebackType
from typing import Self, TextIO

from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, Progress, TaskID, TextColumn

from cli.terminal import console, duration, say_json, visible
from core.states import TaskState
from worker.events import Event, EventKind

PLAIN_INTERVAL_S = 15.0
"""A log gets a line of progress no more often than this, besides one line per finished stage."""


class Display:
    """Shows events; a context manager so that a live bar leaves a clean terminal behind."""

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Leave the terminal as it was."""

    def show(self, event: Event) -> None:
        """Show one event."""
        raise NotImplementedError


class JsonDisplay(Display):
    """One JSON object a line."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def show(self, event: Event) -> None:
        """Print the event with its kind under ``event``."""
        fields = asdict(event)
        self.line({"event": fields.pop("kind"), **fields})

    def line(self, record: dict[str, object]) -> None:
        """Print any record as one line."""
        say_json(record, stream=self._stream)


class PlainDisplay(Display):
    """Lines for logs and pipes."""

    def __init__(self, stream: TextIO, clock: Callable[[], float] = time.monotonic) -> None:
        self._stream = stream
        self._clock = clock
        self._next = clock() + PLAIN_INTERVAL_S
        self._stages = _Stages()

    def show(self, event: Event) -> None:
        """Print finished stages, retries, and now and then where the run is."""
        text = self._stages.finished(event)
        if text is None and event.kind == EventKind.PROGRESS and self._clock() >= self._next:
            text = f"{event.stage} {event.stage_fraction:.0%}"
        if text is None:
            return
        self._next = self._clock() + PLAIN_INTERVAL_S
        line = visible(f"[{event.fraction:4.0%}] {text}{_left(event)}")
        print(line, file=self._stream, flush=True)


class LiveDisplay(Display):
    """One bar for the run above which finished stages scroll by."""

    def __init__(self, console: Console) -> None:
        self._progress = Progress(
            TextColumn("{task.percentage:>3.0f}%"),
            BarColumn(bar_width=30),
            TextColumn("{task.description}"),
            console=console,
            transient=True,
        )
        self._task: TaskID = self._progress.add_task("starting", total=1.0)
        self._stages = _Stages()

    def __enter__(self) -> Self:
        self._progress.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._progress.stop()

    def show(self, event: Event) -> None:
        """Move the bar; a finished stage or a retry gets its line."""
        text = self._stages.finished(event)
        if text is not None:
            self._progress.console.print(escape(visible(text)), highlight=False)
        description = visible((_position(event) or "finishing") + _left(event))
        self._progress.update(self._task, completed=event.fraction, description=escape(description))


class _Stages:
    """Sums what the tasks of a stage took, to say it once when the stage is through."""

    def __init__(self) -> None:
        self._seconds: defaultdict[str, float] = defaultdict(float)
        self._ended: dict[str, Counter[str]] = {}
        self._said: set[str] = set()

    def finished(self, event: Event) -> str | None:
        """The line of a stage whose last task just ended, or of a retry; else None."""
        if event.kind == EventKind.RETRY:
            return f"{event.key}: trying again: {event.message}"
        if event.kind != EventKind.ENDED:
            return None
        stage = event.stage
        self._ended.setdefault(stage, Counter())["reused" if event.reused else event.state] += 1
        if not event.reused:
            self._seconds[stage] += event.seconds or 0.0
        if event.done < event.total or stage in self._said:
            return None
        self._said.add(stage)
        return "  ".join([f"{stage:<14}", *self._parts(stage, event.total)])

    def _parts(self, stage: str, total: int) -> list[str]:
        ended = self._ended[stage]
        if set(ended) == {TaskState.SKIPPED}:
            return [TaskState.SKIPPED]
        parts = [f"{total} tasks"] if total > 1 else []
        parts.append("already there" if set(ended) == {"reused"} else duration(self._seconds[stage]))
        if lost := ended[TaskState.FAILED]:
            parts.append(f"{lost} without a result")
        return parts


def choose(as_json: bool) -> Display:
    """The display that fits: JSON lines on standard output, or a bar or lines on standard error."""
    if as_json:
        return JsonDisplay(sys.stdout)
    terminal = console(error=True)
    return LiveDisplay(terminal) if terminal.is_terminal else PlainDisplay(sys.stderr)


def _position(event: Event) -> str:
    count = f" {event.done}/{event.total}" if event.total > 1 else ""
    return f"{event.stage}{count}"


def _left(event: Event) -> str:
    return f"  (about {duration(event.eta_s)} left)" if event.eta_s else ""
