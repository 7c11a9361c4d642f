"""`bladeatlas cancel`: stop an inspection."""

from __future__ import annotations

import argparse

from cli import remote


def command(parsed: argparse.Namespace) -> int:
    """Ask the server to stop it and print how it stands."""
    with remote.client_of(parsed) as client:
        inspection = client.cancel(parsed.id)
    if parsed.json:
        remote.print_json(inspection.raw)
    else:
        print(remote.line(inspection))
    return 0
