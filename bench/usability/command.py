"""Ask every question of every instrument in a browser, and print the table."""

from __future__ import annotations

import argparse
import json
import shutil
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from bench.usability.instruments import Gallery, Instrument, ReportPage, Viewer
from core.errors import BadInput
from core.inspection_report.document import report_document
from core.inspection_report.forms import Form, written
from core.inspection_report.source import files_below, read_source
from core.outputs import FRAMES, VIEWER_PAGE
from core.report.csv_form import read_csv
from core.study.truth import UNKNOWN, Task, answers, boxed_frame

BROWSER = "chromium-headless-shell"
_FLAGS = ("--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-sandbox")


@dataclass(frozen=True)
class Outcome:
    """What came of one question at one instrument."""

    task: Task
    instrument: str
    answer: str | None
    """None = it cannot be answered there."""
    right: bool
    operators: str
    """As the model writes them, in order."""
    seconds: float
    """Of the model."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of the command."""
    parser.add_argument("result", type=Path, metavar="RESULT", help="output folder of `bladeatlas run`")
    parser.add_argument("--json", action="store_true", help="print JSON instead of a table")


def command(arguments: argparse.Namespace) -> None:
    """Print the table of all outcomes."""
    outcomes = measure(arguments.result)
    if arguments.json:
        print(json.dumps([one.__dict__ for one in outcomes], indent=1))
    else:
        print("\n".join(table(outcomes)))


def measure(result: Path) -> list[Outcome]:
    """Ask every question of the gallery, the page and the report; each begins with a page just opened.

    Raises:
        BadInput: the result has no page or no finding, or there is no browser.
    """
    right = answers(result)
    if not (result / VIEWER_PAGE).is_file():
        raise BadInput(f"'{result}' has no {VIEWER_PAGE}: run `bladeatlas view` on it first", where="RESULT")
    outcomes = []
    with browser_context() as context, tempfile.TemporaryDirectory() as folder:
        for name, (kind, address, boxed) in _instruments(result, Path(folder)).items():
            for task in Task:
                page = context.new_page()
                page.goto(address + (f"#f={boxed}" if kind is Viewer and task is Task.SAME else ""))
                page.locator("main").wait_for()
                page.wait_for_timeout(kind.LAYS_OUT_MS)
                outcomes.append(_asked(kind(page, boxed), name, task, right[task]))
                page.close()
    return outcomes


def _instruments(result: Path, folder: Path) -> dict[str, tuple[type[Instrument], str, int]]:
    """Class, address and number of the frame with the box, by name; the gallery numbers frames as the video does."""
    source = read_source(files_below(result))
    report = folder / "report.html"
    report.write_bytes(written(Form.HTML, report_document(source), source))
    index = boxed_frame(result)
    of_video = {int(row["index"]): int(row["source_index"]) for row in read_csv(result / FRAMES)}[index]
    found: dict[str, tuple[type[Instrument], str, int]] = {}
    gallery = result / "gallery" / "index.html"
    if gallery.is_file():
        found["gallery"] = (Gallery, gallery.resolve().as_uri(), of_video)
    found["viewer"] = (Viewer, (result / VIEWER_PAGE).resolve().as_uri(), index)
    found["report"] = (ReportPage, report.resolve().as_uri(), index)
    return found


def _asked(instrument: Instrument, name: str, task: Task, right: frozenset[str]) -> Outcome:
    way = instrument.tasks.get(task)
    answer = None if way is None else way()
    hand = instrument.hand
    # Where the tables know nothing, saying nothing is right.
    correct = answer in right or (answer is None and right == {UNKNOWN})
    return Outcome(task, name, answer, correct, "".join(hand.done), round(hand.seconds, 2))


@contextmanager
def browser_context() -> Iterator[Any]:
    """A window of the system's headless browser.

    Raises:
        BadInput: there is none.
    """
    program = shutil.which(BROWSER)
    if program is None:
        raise BadInput(f"there is no {BROWSER} on this machine (Debian's package of that name)", where="browser")
    # Loaded here: --help needs no browser.
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=list(_FLAGS))
        try:
            yield browser.new_context(viewport={"width": 1200, "height": 760})
        finally:
            browser.close()


def table(outcomes: Sequence[Outcome]) -> list[str]:
    """One row per question, one column per instrument, in Markdown."""
    names = list(dict.fromkeys(one.instrument for one in outcomes))
    found = {(one.task, one.instrument): one for one in outcomes}
    lines = [f"| question | {' | '.join(names)} |", f"| --- |{' --- |' * len(names)}"]
    return lines + [f"| {task} | {' | '.join(_cell(found[task, name]) for name in names)} |" for task in Task]


def _cell(one: Outcome) -> str:
    if one.answer is None:
        return "nothing to say" if one.right else "not answered"
    return f"{one.answer}, {'right' if one.right else 'WRONG'}, {one.seconds:.1f} s ({one.operators})"
