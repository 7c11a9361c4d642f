"""`bladeatlas run`: check the input, run the plan, say what came out."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from typing import Any

from cli import exits, parameters, progress, report
from cli.recordings import recordings_of
from cli.terminal import say
from core.errors import BadInput
from core.intake import check_input
from core.settings import Settings
from core.stage_specs import STAGES
from core.states import RunState
from core.videos import Recording
from worker.events import Outcome
from worker.local_run import Names, run_inspection


def command(parsed: argparse.Namespace) -> int:
    """Run or continue an inspection; returns the exit code of the contract."""
    wanted = parameters.from_arguments(parsed)
    settings = wanted.settings()
    if parsed.workers is not None and parsed.workers < 1:
        raise BadInput(f"{parsed.workers} workers; at least 1", where="--workers")
    if parsed.from_stage is not None and parsed.from_stage not in STAGES:
        raise BadInput(f"unknown stage '{parsed.from_stage}'; known: {', '.join(STAGES)}", where="--from")
    display = progress.choose(parsed.json)
    with recordings_of(parsed) as recordings:
        check_input(recordings, settings)
        outcome = _run(parsed, recordings, wanted, settings, display)
    code = _code(outcome)
    if isinstance(display, progress.JsonDisplay):
        labels = {"label": wanted.label, "external_id": wanted.external_id}
        display.line({"event": "result", "exit_code": code, **labels, **_record(outcome)})
    elif outcome.state in (RunState.SUCCEEDED, RunState.PARTIAL, RunState.FAILED):
        say(*report.lines(outcome))
    if code == exits.INTERRUPTED:
        say("bladeatlas: interrupted; the same command goes on where it stopped", error=True)
    elif outcome.error is not None:
        say(f"bladeatlas: {exits.one_line(outcome.error)}", error=True)
    return code


def _run(
    parsed: argparse.Namespace,
    recordings: Sequence[Recording],
    wanted: parameters.Parameters,
    settings: Settings,
    display: progress.Display,
) -> Outcome:
    with display:
        return run_inspection(
            recordings,
            parsed.out,
            settings,
            workers=parsed.workers,
            on_event=display.show,
            from_stage=parsed.from_stage,
            force=parsed.force,
            names=Names(wanted.label, wanted.external_id, wanted.metadata),
        )


def _code(outcome: Outcome) -> int:
    if outcome.state == RunState.SUCCEEDED:
        return exits.DONE
    if outcome.state == RunState.PARTIAL:
        return exits.PARTIAL
    if outcome.state in (RunState.INTERRUPTED, RunState.CANCELLED):
        return exits.INTERRUPTED
    return exits.exit_code(outcome.error) if outcome.error else exits.INTERNAL


def _record(outcome: Outcome) -> dict[str, Any]:
    return {
        "state": outcome.state,
        "failed_stage": outcome.failed_stage,
        "reason": outcome.error.code if outcome.error else "",
        "message": outcome.error.message if outcome.error else "",
        "seconds": outcome.seconds,
        "computed": outcome.computed,
        "reused": outcome.reused,
        "out": str(outcome.out),
    }
