"""`bladeatlas submit`: send a video and its annotations to a server and start an inspection."""

from __future__ import annotations

import argparse
from typing import Any

from cli import remote
from cli.annotation_file import optional_annotation_file, with_format
from cli.client.transfers import no_progress
from cli.parameters import Parameters, parse_assignment, read_parameters
from cli.terminal import say, say_json


def command(parsed: argparse.Namespace) -> int:
    """Upload, start, and with `--wait` show it until it is over; prints the id first."""
    parameters = _parameters(parsed)
    with remote.client_of(parsed) as client:
        with remote.byte_bars() as bars:
            on_bytes = bars.show if bars is not None else no_progress
            with optional_annotation_file(parsed.annotations) as annotations:
                inspection = client.submit(parsed.video, annotations, parameters, on_bytes=on_bytes)
        if parsed.json:
            say_json(inspection.raw)
        else:
            say(inspection.id)
        if not parsed.wait:
            return 0
        last = remote.follow(client, inspection, parsed.json)
    if not parsed.json:
        say(remote.line(last), error=True)
    return remote.exit_code(last)


def _parameters(parsed: argparse.Namespace) -> dict[str, Any]:
    """Parameter file first, then what the command line says over it; checked here before anything is sent."""
    base = read_parameters(parsed.parameters) if parsed.parameters else Parameters()
    options = {**base.options, **dict(parse_assignment(text) for text in with_format(parsed))}
    wanted = Parameters(
        parsed.preset or base.preset, options, parsed.label or base.label, parsed.external_id or base.external_id
    )
    wanted.settings()
    return {
        "preset": wanted.preset,
        "options": wanted.options,
        "label": wanted.label,
        "external_id": wanted.external_id,
    }
