"""`bladeatlas version`."""

from __future__ import annotations

import argparse

from cli.terminal import say, say_json
from core.versions import all_versions


def command(parsed: argparse.Namespace) -> int:
    """Print the versions of the program and its engines."""
    versions = all_versions()
    if parsed.json:
        say_json({"schema_version": 1, "versions": versions}, indent=1)
    else:
        for name, number in versions.items():
            say(f"{name} {number}")
    return 0
