"""`bladeatlas download`: fetch the files of an inspection."""

from __future__ import annotations

import argparse

from cli import remote
from cli.client.client import chosen
from cli.client.transfers import no_progress
from cli.terminal import say, say_json
from core.errors import BadInput


def command(parsed: argparse.Namespace) -> int:
    """Fetch files into a folder; what is there already is left alone, what was cut off goes on."""
    out = remote.folder_of(parsed)
    with remote.client_of(parsed) as client, remote.byte_bars() as bars:
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
