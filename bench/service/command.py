"""`bladeatlas-bench service`: choose measurements, run them one after the other, print tables."""

from __future__ import annotations

import argparse
import json
import tempfile
from collections.abc import Callable
from pathlib import Path

from bench.service.interrupted import interrupted
from bench.service.load import load
from bench.service.overhead import overhead
from bench.service.scaling import scaling
from bench.service.transfers import downloads, uploads
from bench.speed.timing import Table
from core.errors import BadInput
from core.settings import PRESET_NAMES

NAMES = ("uploads", "downloads", "interrupted", "load", "overhead", "scaling")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    parser.add_argument("--only", default=",".join(NAMES), metavar="NAME,...", help=f"of: {', '.join(NAMES)}")
    parser.add_argument("--repeat", type=int, default=3, metavar="N", help="runs of each side, in turn (3)")
    parser.add_argument("--preset", default="default", choices=PRESET_NAMES, help="of the sample's jobs (default)")
    parser.add_argument("--json", action="store_true", help="print JSON instead of tables")


def command(arguments: argparse.Namespace) -> None:
    """Run the chosen measurements, each in a folder of its own that is removed."""
    repeat, preset = arguments.repeat, arguments.preset
    known: dict[str, Callable[[Path], Table]] = {
        "uploads": lambda folder: uploads(folder, repeat),
        "downloads": lambda folder: downloads(folder, repeat),
        "interrupted": interrupted,
        "load": load,
        "overhead": lambda folder: overhead(folder, repeat, preset),
        "scaling": lambda folder: scaling(folder, repeat, preset),
    }
    names = [name for name in arguments.only.split(",") if name]
    for name in names:
        if name not in known:
            raise BadInput(f"unknown measurement '{name}'; known: {', '.join(NAMES)}", where="--only")
    if repeat < 1:
        raise BadInput("--repeat is at least 1", where="--repeat")
    done = []
    for name in names:
        with tempfile.TemporaryDirectory(prefix="bladeatlas-bench-") as folder:
            done.append(known[name](Path(folder)))
        if not arguments.json:
            print(done[-1].text(), end="\n\n", flush=True)
    if arguments.json:
        tables = [{"name": t.name, "title": t.title, "rows": [row.to_dict() for row in t.rows]} for t in done]
        print(json.dumps({"schema_version": 1, "tables": tables}, indent=1, allow_nan=False))
