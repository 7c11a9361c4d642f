"""`bladeatlas-bench speed` and `service`: choose measurements, run them one after the other, print tables."""

from __future__ import annotations

import argparse
import importlib
import json
import tempfile
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path

from bench.service.hostile import SECONDS as HOSTILE_S
from bench.service.hostile import hostile
from bench.service.interrupted import interrupted
from bench.service.load import load
from bench.service.overhead import overhead
from bench.service.scaling import scaling
from bench.service.transfers import downloads, uploads
from bench.speed.finished import FinishedRun, open_run
from bench.speed.timing import Table
from core.errors import BadInput
from core.settings import PRESET_NAMES
from store.settings import available_cores

COMPARISONS = ("stages", "disk", "matching", "windows", "dense", "mapping")
"""Of a finished run with other programs."""
SERVICE = ("uploads", "downloads", "interrupted", "load", "hostile", "overhead", "scaling", "generated")
"""Of a whole deployment."""


def add_speed_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of `speed`."""
    parser.add_argument("result", type=Path, metavar="RESULT", help="folder of a finished `bladeatlas run`")
    _add_choice(parser, COMPARISONS)
    parser.add_argument("--threads", type=int, metavar="N", help="threads of each side (number of cores)")
    parser.add_argument("--json", action="store_true", help="print JSON instead of tables")


def speed(arguments: argparse.Namespace) -> None:
    """Run the chosen comparisons on a finished run."""
    names = _chosen(arguments.only, COMPARISONS, "comparison")
    if arguments.repeat < 1 or (arguments.threads is not None and arguments.threads < 1):
        raise BadInput("--repeat and --threads are at least 1", where="--repeat")
    threads = arguments.threads or available_cores()
    with open_run(arguments.result) as run:
        _print(_comparisons(run, names, threads, arguments.repeat), as_json=arguments.json)


def _comparisons(run: FinishedRun, names: Sequence[str], threads: int, repeat: int) -> Iterator[Table]:
    """One table a comparison; its module, and with it the libraries, is loaded only when it is asked for."""
    for name in names:
        module = importlib.import_module(f"bench.speed.{name}")
        yield module.compare(run, threads=threads, repeat=repeat)


def add_service_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of `service`."""
    _add_choice(parser, SERVICE)
    parser.add_argument("--preset", default="default", choices=PRESET_NAMES, help="of the sample's jobs (default)")
    parser.add_argument("--seconds", type=float, default=HOSTILE_S, metavar="N", help="of `hostile` (600)")
    parser.add_argument("--json", action="store_true", help="print JSON instead of tables")


def service(arguments: argparse.Namespace) -> None:
    """Run the chosen measurements, each in a folder of its own that is removed."""
    names = _chosen(arguments.only, SERVICE, "measurement")
    if arguments.repeat < 1 or arguments.seconds <= 0:
        raise BadInput("--repeat is at least 1, --seconds above 0", where="--repeat")
    _print(_measured(names, arguments.repeat, arguments.preset, arguments.seconds), as_json=arguments.json)


def _measured(names: Sequence[str], repeat: int, preset: str, seconds: float) -> Iterator[Table]:
    known: dict[str, Callable[[Path], Table]] = {
        "uploads": lambda folder: uploads(folder, repeat),
        "downloads": lambda folder: downloads(folder, repeat),
        "interrupted": interrupted,
        "load": load,
        "hostile": lambda folder: hostile(folder, seconds),
        "overhead": lambda folder: overhead(folder, repeat, preset),
        "scaling": lambda folder: scaling(folder, repeat, preset),
        "generated": _generated,
    }
    for name in names:
        with tempfile.TemporaryDirectory(prefix="bladeatlas-bench-") as folder:
            yield known[name](Path(folder))


def _generated(folder: Path) -> Table:
    try:
        from bench.service.generated import generated
    except ImportError as error:  # it needs schemathesis, which only developers have
        raise BadInput(f"{error.name} is not installed on this machine", where="generated") from None
    return generated(folder)


def _add_choice(parser: argparse.ArgumentParser, names: Sequence[str]) -> None:
    parser.add_argument("--only", default=",".join(names), metavar="NAME,...", help=f"of: {', '.join(names)}")
    parser.add_argument("--repeat", type=int, default=3, metavar="N", help="runs of each side, in turn (3)")


def _chosen(only: str, known: Sequence[str], what: str) -> list[str]:
    names = [name for name in only.split(",") if name]
    for name in names:
        if name not in known:
            raise BadInput(f"unknown {what} '{name}'; known: {', '.join(known)}", where="--only")
    return names


def _print(tables: Iterable[Table], *, as_json: bool) -> None:
    """Each table as soon as it is there, or all of them as one JSON object."""
    done = []
    for table in tables:
        done.append(table)
        if not as_json:
            print(table.text(), end="\n\n", flush=True)
    if as_json:
        rows = [{"name": t.name, "title": t.title, "rows": [row.to_dict() for row in t.rows]} for t in done]
        print(json.dumps({"schema_version": 1, "tables": rows}, indent=1, allow_nan=False))
