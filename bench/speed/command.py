"""`bladeatlas-bench speed`: choose comparisons, run them one after the other, print tables."""

from __future__ import annotations

import argparse
import importlib
import json
from collections.abc import Iterator
from pathlib import Path

from bench.speed.finished import FinishedRun, open_run
from bench.speed.timing import Table
from core.errors import BadInput
from store.settings import available_cores

NAMES = ("stages", "disk", "matching", "windows", "dense", "mapping")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    parser.add_argument("result", type=Path, metavar="RESULT", help="folder of a finished `bladeatlas run`")
    parser.add_argument("--only", default=",".join(NAMES), metavar="NAME,...", help=f"of: {', '.join(NAMES)}")
    parser.add_argument("--repeat", type=int, default=3, metavar="N", help="runs of each side, in turn (3)")
    parser.add_argument("--threads", type=int, metavar="N", help="threads of each side (number of cores)")
    parser.add_argument("--json", action="store_true", help="print JSON instead of tables")


def command(arguments: argparse.Namespace) -> None:
    """Run the chosen comparisons on a finished run."""
    names = [name for name in arguments.only.split(",") if name]
    for name in names:
        if name not in NAMES:
            raise BadInput(f"unknown comparison '{name}'; known: {', '.join(NAMES)}", where="--only")
    if arguments.repeat < 1 or (arguments.threads is not None and arguments.threads < 1):
        raise BadInput("--repeat and --threads are at least 1", where="--repeat")
    threads = arguments.threads or available_cores()
    done = []
    with open_run(arguments.result) as run:
        for table in tables(run, names, threads, arguments.repeat):
            done.append(table)
            if not arguments.json:
                print(table.text(), end="\n\n", flush=True)
    if arguments.json:
        rows = [{"name": t.name, "title": t.title, "rows": [row.to_dict() for row in t.rows]} for t in done]
        print(json.dumps({"schema_version": 1, "tables": rows}, indent=1, allow_nan=False))


def tables(run: FinishedRun, names: list[str], threads: int, repeat: int) -> Iterator[Table]:
    """One table a comparison; its module, and with it the libraries, is loaded only when it is asked for."""
    for name in names:
        module = importlib.import_module(f"bench.speed.{name}")
        yield module.compare(run, threads=threads, repeat=repeat)
