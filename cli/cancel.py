"""`bladeatlas cancel`: stop an inspection."""

from __future__ import annotations

import argparse

from cli import remote
from cli.terminal import say, say_json


def command(parsed: argparse.Namespace) -> int:
    """Ask the server to stop it and print how it stands."""
    with remote.client_of(parsed) as client:
        inspection = client.cancel(parsed.id)
    if parsed.json:
        say_json(inspection.raw)
    else:
        say(remote.line(inspection))
    return 0
