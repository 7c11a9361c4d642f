"""`bladeatlas-bench row`: is the row found where there is one, and unknown where there is none."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path

from bench.arguments import add_results
from bench.kept import Found
from bench.row.cases import FAMILIES
from core.errors import BadInput


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    parser.add_argument(
        "out", type=Path, metavar="OUT", help="folder of truths, results and scores; it is gone on with"
    )
    parser.add_argument(
        "--family", choices=[*FAMILIES, "all", "none"], default="all", help="true surfaces of which scenes (all)"
    )
    parser.add_argument("--only", metavar="NAME,...", default="", help="of these names")
    add_results(parser, "its row is computed anew in OUT")
    parser.add_argument(
        "--unknown",
        type=Path,
        action="append",
        default=[],
        metavar="RESULT",
        help="a result of something that is no row, without a truth (repeatable)",
    )


def command(arguments: argparse.Namespace) -> None:
    """Score what is missing, and print the table and what all of it comes to; standard error tells each one's end."""
    # Imported here so that --help does not load the vision libraries.
    from bench.row.measure import Bench
    from bench.row.table import markdown, totals

    cases = [case for name, family in FAMILIES.items() if arguments.family in (name, "all") for case in family]
    wanted = [name for name in arguments.only.split(",") if name]
    unknown = set(wanted) - {case.name for case in cases}
    if unknown:
        raise BadInput(f"no case is called {', '.join(sorted(unknown))}", where="--only")
    bench, found = Bench(arguments.out), []

    def scores() -> Iterator[Found]:
        for case in cases:
            if not wanted or case.name in wanted:
                yield bench.of_case(case)
        for result, truth in arguments.results:
            yield bench.of_result(result, truth)
        for result in arguments.unknown:
            yield bench.of_result(result, None)

    for one in scores():
        found.append(one)
        print(f"{one['name']}: {one['status']}, {one['seconds']:.0f} s", file=sys.stderr, flush=True)
    print(markdown(found) + "\n\n" + "\n".join(totals(found)))
