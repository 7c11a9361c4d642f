"""The commands that talk to a server: submit, status, watch, download and cancel; and what they have in common."""

from __future__ import annotations

import argparse
import os
import sys
from itertools import islice
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from rich.markup import escape
from rich.progress import BarColumn, DownloadColumn, Progress, TaskID, TextColumn, TransferSpeedColumn

from cli import exits
from cli.client import Client, InspectionInfo
from cli.client.client import chosen
from cli.client.transfers import no_progress
from cli.input_files import calibration_options, limit_options, with_format
from cli.parameters import Parameters, parse_assignment, parse_priority, read_parameters
from cli.recordings import as_files, recordings_of
from cli.terminal import console, duration, say, say_json, visible
from core.errors import BadInput
from core.states import InspectionState

DEFAULT_SERVER = "http://127.0.0.1:8000"
SERVER_VARIABLE = "BLADEATLAS_SERVER"
KEY_VARIABLE = "BLADEATLAS_API_KEY"


def submit(parsed: argparse.Namespace) -> int:
    """Upload, start, and with `--wait` show it until it is over; prints the id first."""
    parameters = _submitted_parameters(parsed)
    with client_of(parsed) as client:
        with byte_bars() as bars:
            on_bytes = bars.show if bars is not None else no_progress
            with recordings_of(parsed) as recordings, as_files(recordings) as sent:
                first, *further = sent
                inspection = client.submit(
                    first.video, first.annotations, parameters, further=further, on_bytes=on_bytes
                )
        if parsed.json:
            say_json(inspection.raw)
        else:
            say(inspection.id)
        if not parsed.wait:
            return 0
        last = follow(client, inspection, parsed.json)
    if not parsed.json:
        say(line(last), error=True)
    return exit_code(last)


def _submitted_parameters(parsed: argparse.Namespace) -> dict[str, Any]:
    """Parameter file first, then what the command line says over it; checked here before anything is sent."""
    base = read_parameters(parsed.parameters) if parsed.parameters else Parameters()
    options = {**base.options, **calibration_options(parsed.calibration), **limit_options(parsed.limits)}
    options.update(parse_assignment(text) for text in with_format(parsed))
    priority = base.priority if parsed.priority is None else parse_priority(parsed.priority, "--priority")
    wanted = Parameters(
        parsed.preset or base.preset,
        options,
        parsed.label or base.label,
        parsed.external_id or base.external_id,
        priority,
        base.metadata,
    )
    wanted.settings()
    return {
        "preset": wanted.preset,
        "options": wanted.options,
        "label": wanted.label,
        "external_id": wanted.external_id,
        "priority": wanted.priority,
        "metadata": wanted.metadata,
    }


def status(parsed: argparse.Namespace) -> int:
    """Print one line per inspection, or JSON lines."""
    with client_of(parsed) as client:
        if parsed.id is not None:
            found = [client.get(parsed.id)]
        else:
            filters = {"state": parsed.state} if parsed.state else {}
            found = list(islice(client.list(limit=min(parsed.limit, 200), **filters), parsed.limit))
    for inspection in found:
        if parsed.json:
            say_json(inspection.raw)
        else:
            say(line(inspection))
    return 0


def watch(parsed: argparse.Namespace) -> int:
    """Follow it; the exit code is that of `bladeatlas run`. Interrupting stops the watching only."""
    with client_of(parsed) as client:
        last = follow(client, client.get(parsed.id), parsed.json)
    if not parsed.json:
        say(line(last))
    return exit_code(last)


def download(parsed: argparse.Namespace) -> int:
    """Fetch files into a folder; what is there already is left alone, what was cut off goes on."""
    out = folder_of(parsed)
    with client_of(parsed) as client, byte_bars() as bars:
        found = chosen(client.artifacts(parsed.id), parsed.include)
        if not found:
            raise BadInput("there is no such file; it may not be published yet", code="no_files", where="--include")
        for artifact in found:
            path = client.download(parsed.id, artifact, out, bars.show if bars is not None else no_progress)
            if parsed.json:
                say_json({"path": str(path), "size": artifact.size, "sha256": artifact.sha256})
    if not parsed.json:
        say(f"{len(found)} files in {out}")
    return 0


def cancel(parsed: argparse.Namespace) -> int:
    """Ask the server to stop it and print how it stands."""
    with client_of(parsed) as client:
        inspection = client.cancel(parsed.id)
    if parsed.json:
        say_json(inspection.raw)
    else:
        say(line(inspection))
    return 0


def client_of(parsed: argparse.Namespace) -> Client:
    """The client that the arguments and the environment ask for."""
    server = parsed.server or os.environ.get(SERVER_VARIABLE) or DEFAULT_SERVER
    return Client(server, _key(parsed))


def _key(parsed: argparse.Namespace) -> str | None:
    """The API key, from a file or a variable: an argument could be read by everybody on the machine."""
    if parsed.key_file is not None:
        try:
            return str(parsed.key_file.read_text(encoding="utf-8").strip())
        except (OSError, UnicodeDecodeError) as error:
            raise BadInput(f"cannot read the key file: {error}", where="--key-file") from None
    if parsed.key_env is not None and parsed.key_env not in os.environ:
        raise BadInput(f"there is no variable '{parsed.key_env}'", where="--key-env")
    return os.environ.get(parsed.key_env or KEY_VARIABLE) or None


def exit_code(inspection: InspectionInfo) -> int:
    """The exit code of the contract for an inspection that is over."""
    by_state: dict[str, int] = {
        InspectionState.SUCCEEDED: exits.DONE,
        InspectionState.PARTIAL: exits.PARTIAL,
        InspectionState.CANCELLED: exits.INTERRUPTED,
    }
    if inspection.state in by_state:
        return by_state[inspection.state]
    code = (inspection.error or {}).get("code")
    return {"bad_input": exits.BAD_INPUT, "no_reconstruction": exits.NO_RECONSTRUCTION}.get(str(code), exits.INTERNAL)


def line(inspection: InspectionInfo) -> str:
    """An inspection in one line."""
    parts = [inspection.id, inspection.state, f"{inspection.progress:.0%}"]
    if inspection.stage:
        parts.append(inspection.stage)
    if inspection.eta_s:
        parts.append(f"({duration(inspection.eta_s[0])} to {duration(inspection.eta_s[1])} left)")
    if inspection.label:
        parts.append(inspection.label)
    if inspection.error:
        parts.append(f"{inspection.error.get('code')}: {inspection.error.get('detail')}")
    return "  ".join(parts)


def follow(client: Client, inspection: InspectionInfo, as_json: bool) -> InspectionInfo:
    """Show an inspection until it is over; JSON lines, a bar on a terminal, or a line per stage in a log."""
    last, shown = inspection, ""
    with _bar() as bar:
        for last in client.watch(inspection.id):
            if as_json:
                say_json(last.raw)
            elif bar is not None:
                bar.show(last.stage or last.state, round(last.progress * 1000), 1000)
            elif f"{last.state} {last.stage}" != shown:
                shown = f"{last.state} {last.stage}"
                say(line(last), error=True)
    return last


class Bars:
    """A bar per file or inspection on standard error."""

    def __init__(self, *, of_bytes: bool) -> None:
        columns = (DownloadColumn(), TransferSpeedColumn()) if of_bytes else (TextColumn("{task.percentage:>3.0f}%"),)
        terminal = console(error=True)
        self._progress = Progress(BarColumn(30), *columns, TextColumn("{task.description}"), console=terminal)
        self._tasks: dict[str, TaskID] = {}
        self._one = not of_bytes

    def __enter__(self) -> Self:
        self._progress.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._progress.stop()

    def show(self, name: str, done: int, total: int) -> None:
        """Move the bar of a file; for an inspection there is only one, whose text changes."""
        known = "" if self._one else name
        if known not in self._tasks:
            self._tasks[known] = self._progress.add_task(escape(visible(name)), total=total)
        self._progress.update(self._tasks[known], completed=done, total=total, description=escape(visible(name)))


class Silence:
    """No bar: the output is a log or is read by a program."""

    def __enter__(self) -> None:
        return None

    def __exit__(self, *_: object) -> None:
        """Nothing to end."""


def _bar() -> Bars | Silence:
    return Bars(of_bytes=False) if sys.stderr.isatty() else Silence()


def byte_bars() -> Bars | Silence:
    """Bars for transfers where there is a terminal to show them."""
    return Bars(of_bytes=True) if sys.stderr.isatty() else Silence()


def folder_of(parsed: argparse.Namespace) -> Path:
    """Where downloads go: the folder asked for, or one with the inspection's name."""
    return Path(parsed.out) if parsed.out is not None else Path(parsed.id)
