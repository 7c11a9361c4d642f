"""`bladeatlas-bench mutate`: draw mutants of an area, run the tests that reach each, print those that none notices.

Two runs at a time, each in a copy of the repository.
"""

from __future__ import annotations

import argparse
import os
import queue
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

from bench.mutate.areas import AREAS, Area
from bench.mutate.mutants import Mutant, mutants_of
from bench.mutate.reach import Reach, environment, measure, pytest_arguments
from core.errors import BadInput

WORKERS = 2
"""Runs of tests side by side."""
STARTING_S = 20.0
"""Processor time that a run may take beyond its tests: loading the libraries."""
TIMES_AS_LONG = 6.0
"""A run whose processor time is this many times as long as its tests took without a change does not end, which the
tests notice; on two cores that is three times as long. Other work of the machine makes no run look endless."""
WAITING = 5.0
"""A run that waits for something ends after this many times its processor time."""
ROOT = Path(__file__).parents[2]


class Fate(StrEnum):
    """What became of a mutant."""

    KILLED = "killed"
    """A test failed."""
    SURVIVED = "survived"
    UNREACHED = "unreached"
    """No test runs its lines."""
    NOT_RUN = "not run"
    """The time was over."""


@dataclass(frozen=True)
class Verdict:
    """What became of a mutant."""

    mutant: Mutant
    fate: Fate
    text: str
    """Where it is, and the change."""


def draw(root: Path, area: Area, number: int, seed: int) -> list[Mutant]:
    """As many of the area's mutants as asked for, in random order; all are equally likely."""
    found = [
        mutant for module in area.sources(root) for mutant in mutants_of(str(module), (root / module).read_bytes())
    ]
    return random.Random(seed).sample(found, min(number, len(found)))


def judge(root: Path, work: Path, area: Area, drawn: Sequence[Mutant], limit_s: float) -> Iterator[Verdict]:
    """The fate of each mutant, in the order in which they are known; those after the time limit are not run."""
    end = time.monotonic() + limit_s
    copies: queue.Queue[Path] = queue.Queue()
    for number in range(WORKERS):
        copies.put(copy_repository(root, work / f"copy{number}"))
    modules = [str(module) for module in area.sources(root)]
    reach = measure(work / "copy0", modules, area.tests)

    def one(number: int) -> Verdict:
        mutant = drawn[number]
        source = (root / mutant.path).read_bytes()
        tests = reach.tests_for(mutant.path, mutant.first, mutant.last)
        copy = copies.get()
        try:
            fate = _fate(copy, mutant, source, tests, reach, number, end)
        finally:
            copies.put(copy)
        return Verdict(mutant, fate, mutant.describe(source))

    with ThreadPoolExecutor(WORKERS) as pool:
        for ended in as_completed([pool.submit(one, number) for number in range(len(drawn))]):
            yield ended.result()


def copy_repository(root: Path, to: Path) -> Path:
    """Copy what git tracks, and what is new and not ignored, as it is in the working tree."""
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=root,
        capture_output=True,
        check=True,
    )
    for name in listed.stdout.decode().split("\0"):
        if name and (root / name).is_file():
            (to / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(root / name, to / name)
    return to


def _fate(
    copy: Path, mutant: Mutant, source: bytes, tests: Sequence[str], reach: Reach, number: int, end: float
) -> Fate:
    if not tests:
        return Fate.UNREACHED
    if time.monotonic() > end:
        return Fate.NOT_RUN
    path = copy / mutant.path
    try:
        _write(path, mutant.apply(source), 2 * number)
        return Fate.SURVIVED if _passes(copy, tests, TIMES_AS_LONG * reach.time_of(tests) + STARTING_S) else Fate.KILLED
    finally:
        _write(path, source, 2 * number + 1)


def _write(path: Path, text: bytes, number: int) -> None:
    """Write a module with a time of change that it never had: caches of compiled code are kept by size and time."""
    path.write_bytes(text)
    os.utime(path, (10**9 + number, 10**9 + number))


def _passes(copy: Path, tests: Sequence[str], limit_s: float) -> bool:
    """Whether the tests pass within `limit_s` of processor time; a crash is a failure."""
    seconds = int(limit_s) + 1
    command = [sys.executable, "-m", "pytest", *pytest_arguments(tests)]
    run = subprocess.Popen(
        command,
        cwd=copy,
        env=environment(copy),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )
    resource.prlimit(run.pid, resource.RLIMIT_CPU, (seconds, seconds))
    try:
        code = run.wait(WAITING * limit_s)
    except subprocess.TimeoutExpired:
        return False
    finally:
        if run.poll() is None:
            os.killpg(run.pid, signal.SIGKILL)
            run.wait()
    if code > 2:
        raise BadInput(f"pytest ended with {code} on {' '.join(tests)}")
    return code == 0


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
    fates: Counter[Fate] = Counter()
    with tempfile.TemporaryDirectory(prefix="mutate-") as work:
        for verdict in judge(ROOT, Path(work), area, drawn, 60 * arguments.minutes):
            fates[verdict.fate] += 1
            if verdict.fate != Fate.KILLED:
                print(f"{verdict.fate}: {verdict.text}", flush=True)
    judged = len(drawn) - fates[Fate.NOT_RUN]
    print(
        f"{arguments.area}: {fates[Fate.KILLED]} of {judged} killed ({fates[Fate.KILLED] / max(judged, 1):.0%}), "
        f"{fates[Fate.SURVIVED]} survived, {fates[Fate.UNREACHED]} on lines that no test runs, "
        f"{fates[Fate.NOT_RUN]} not run; "
        f"{(time.monotonic() - start) / 60:.1f} min"
    )
