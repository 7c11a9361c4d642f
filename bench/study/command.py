"""`bladeatlas-bench study`: what the people of a study did, and what may be said of it."""

from __future__ import annotations

import argparse
import json
import statistics
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from bench.study.comparison import NEEDED, Difference, differences, missing
from bench.study.records import Condition, Person, read_people
from core.study.truth import Task


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of the command."""
    parser.add_argument("files", type=Path, nargs="+", metavar="FILES", help="JSON files that the study saved")
    parser.add_argument(
        "--answers", type=Path, required=True, metavar="FILE", help="answers.json that `bladeatlas study` wrote"
    )
    parser.add_argument("--json", action="store_true", help="print JSON instead of tables")


def command(arguments: argparse.Namespace) -> None:
    """Print who took part and, when they are enough, how the page differs from the gallery."""
    people = read_people(arguments.files, arguments.answers)
    if arguments.json:
        print(json.dumps(summary(people), indent=1, allow_nan=False))
    else:
        print("\n".join(lines(people)))


def summary(people: Sequence[Person]) -> dict[str, object]:
    """What `--json` prints: people, what is missing, and the differences, null as long as people are missing."""
    lacks = missing(people)
    return {
        "schema_version": 1,
        "people": [{"participant": one.participant, "group": one.group, "minutes": one.minutes} for one in people],
        "needed": NEEDED,
        "missing": lacks or None,
        "differences": None if lacks else [asdict(one) for one in differences(people)],
    }


def lines(people: Sequence[Person]) -> list[str]:
    """Tables in Markdown."""
    told = ["| number | group | minutes |", "| --- | --- | --- |"]
    told += [f"| {one.participant} | {one.group + 1} | {one.minutes:.1f} |" for one in people]
    lacks = missing(people)
    if lacks:
        return [*told, "", lacks]
    found = differences(people)
    return [*told, "", *_compared(found), "", *_by_task(people), "", *[_sentence(one) for one in found]]


def _compared(found: Sequence[Difference]) -> list[str]:
    head = ["| measure | gallery | page | page - gallery (95 %) | by chance |", "| --- | --- | --- | --- | --- |"]
    return head + [
        f"| {one.measure} | {one.gallery:.2f} | {one.page:.2f} | {one.difference:+.2f} ({one.low:+.2f} to "
        f"{one.high:+.2f}) | {one.chance:.4f} |"
        for one in found
    ]


def _by_task(people: Sequence[Person]) -> list[str]:
    """Of every question the share of right answers and the median time; said, not tested."""
    kinds = tuple(Condition)
    rows = [f"| question | {' | '.join(f'{kind}: right, median time' for kind in kinds)} |", "| --- | --- | --- |"]
    for task in Task:
        cells = []
        for kind in kinds:
            own = [given for one in people for given in one.parts[kind].given if given.task == task]
            share = sum(given.right for given in own) / len(own)
            cells.append(f"{100 * share:.0f} %, {statistics.median(given.seconds for given in own):.0f} s")
        rows.append(f"| {task} | {' | '.join(cells)} |")
    return rows


def _sentence(one: Difference) -> str:
    if one.page_is_better is None:
        return f"{one.measure}: this study does not tell whether they differ."
    return f"{one.measure}: the {'page' if one.page_is_better else 'gallery'} was better."
