"""`bladeatlas-bench mutate`: draw mutants of an area, run its tests on each, print those that no test notices."""

from __future__ import annotations

import argparse
import tempfile
import time
from collections import Counter
from pathlib import Path

from bench.mutate.areas import AREAS
from bench.mutate.run import draw, judge
from core.errors import BadInput

ROOT = Path(__file__).parents[2]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    parser.add_argument("area", metavar="AREA", help=f"one of {', '.join(AREAS)}")
    parser.add_argument("--number", type=int, default=60, metavar="N", help="mutants to draw (60)")
    parser.add_argument("--seed", type=int, default=0, metavar="N", help="of the draw (0)")
    parser.add_argument("--minutes", type=float, default=25.0, metavar="N", help="start no run after this (25)")


def command(arguments: argparse.Namespace) -> None:
    """Print every mutant that survives, and the share of those that were killed."""
    area = AREAS.get(arguments.area)
    if area is None:
        raise BadInput(f"unknown area '{arguments.area}'; known: {', '.join(AREAS)}", where="AREA")
    start = time.monotonic()
    drawn = draw(ROOT, area, arguments.number, arguments.seed)
    fates: Counter[str] = Counter()
    with tempfile.TemporaryDirectory(prefix="mutate-") as work:
        for verdict in judge(ROOT, Path(work), area, drawn, 60 * arguments.minutes):
            fates[verdict.fate] += 1
            if verdict.fate != "killed":
                print(f"{verdict.fate}: {verdict.text}", flush=True)
    judged = len(drawn) - fates["not run"]
    print(
        f"{arguments.area}: {fates['killed']} of {judged} killed ({fates['killed'] / max(judged, 1):.0%}), "
        f"{fates['survived']} survived, {fates['unreached']} on lines that no test runs, {fates['not run']} not run; "
        f"{(time.monotonic() - start) / 60:.1f} min"
    )
