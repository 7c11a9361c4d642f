"""`bladeatlas watch`: show an inspection until it is over."""

from __future__ import annotations

import argparse

from cli import remote
from cli.terminal import say


def command(parsed: argparse.Namespace) -> int:
    """Follow it; the exit code is that of `bladeatlas run`. Interrupting stops the watching only."""
    with remote.client_of(parsed) as client:
        last = remote.follow(client, client.get(parsed.id), parsed.json)
    if not parsed.json:
        say(remote.line(last))
    return remote.exit_code(last)
