"""`bladeatlas status`: how one inspection stands, or a list of the latest."""

from __future__ import annotations

import argparse
from itertools import islice

from cli import remote
from cli.terminal import say, say_json


def command(parsed: argparse.Namespace) -> int:
    """Print one line per inspection, or JSON lines."""
    with remote.client_of(parsed) as client:
        if parsed.id is not None:
            found = [client.get(parsed.id)]
        else:
            filters = {"state": parsed.state} if parsed.state else {}
            found = list(islice(client.list(limit=min(parsed.limit, 200), **filters), parsed.limit))
    for inspection in found:
        if parsed.json:
            say_json(inspection.raw)
        else:
            say(remote.line(inspection))
    return 0
