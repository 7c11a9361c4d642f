"""Window search against COLMAP's mapper with its defaults, from scratch, window by window."""

from __future__ import annotations

import multiprocessing
import time
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from bench.speed.finished import FinishedRun
from bench.speed.timing import Row, Table
from core.errors import StageFailed
from core.products.contract import Products
from core.products.front import FramesProduct
from core.settings import make_settings
from core.settings.groups import MapperSettings
from core.task_key import key_of
from core.windows import Window, coarse_windows

CAP_S = 1200.0
"""A window that takes longer counts as this much."""


@dataclass(frozen=True)
class Mapped:
    """One window mapped one way."""

    seconds: float
    registered_images: int
    points3D: int  # noqa: N815  # COLMAP's name
    finished: bool


def choose_windows(n_search: int, run: FinishedRun, count: int = 3) -> list[Window]:
    """Whole windows spread over the clip, with about the search's own share of starts from scratch."""
    windows = coarse_windows(n_search, run.settings.windows)
    whole = [w for w in windows if w.end - w.start == max(w.end - w.start for w in windows)]
    last = len(whole) - 1
    rows = sorted({min(last, i * len(whole) // count + i) for i in range(count)})
    return [whole[row] for row in rows]


def compare(run: FinishedRun, *, threads: int, repeat: int, cap_s: float = CAP_S) -> Table:
    """Map the windows as the run does and as COLMAP does by default, `repeat` times in turn."""
    n_search = Products(run.facts).of(FramesProduct, "frames").n_search
    colmap = make_settings("thesis").mapper
    rows, totals = [], {"ours": 0.0, "colmap": 0.0}
    for window in choose_windows(n_search, run):
        start = run.folders.get(key_of("coarse", part=window.warm_from)) if window.warm_from else None
        ours, theirs = [], []
        for _ in range(repeat):
            ours.append(_timed(run, window, run.settings.mapper, start, threads, cap_s))
            theirs.append(_timed(run, window, colmap, None, threads, cap_s))
        mine, other = (sorted(side, key=lambda m: m.seconds)[len(side) // 2] for side in (ours, theirs))
        totals["ours"] += mine.seconds
        totals["colmap"] += other.seconds
        how = "warm" if start else "scratch"
        rows += [
            Row(f"{window.name} ({how})", mine.seconds, f"s, {mine.registered_images} images, {mine.points3D} points"),
            Row(f"{window.name} COLMAP", other.seconds, _counts(other)),
        ]
    ratio = Row("ratio of the sums", totals["colmap"] / totals["ours"], "x", "at least 4")
    return Table("windows", f"{len(rows) // 2} windows, {threads} threads, median of {repeat}", (*rows, ratio))


def _counts(mapped: Mapped) -> str:
    if not mapped.finished:
        return "s, stopped at the cap"
    return f"s, {mapped.registered_images} images, {mapped.points3D} points"


def _timed(
    run: FinishedRun, window: Window, settings: MapperSettings, start: Path | None, threads: int, cap_s: float
) -> Mapped:
    """Map in a child process, as the runner does; it is stopped at the cap."""
    context = multiprocessing.get_context("spawn")
    receiver, sender = context.Pipe(duplex=False)
    arguments = (sender, run.folder("graph"), window, settings, run.settings.seed, threads, start)
    child = context.Process(target=_map, args=arguments, daemon=True)
    child.start()
    sender.close()
    try:
        receiver.recv()  # libraries are loaded: from here on it counts
        began = time.perf_counter()
        if not receiver.poll(cap_s):
            return Mapped(cap_s, 0, 0, finished=False)
        images, points = receiver.recv()
        return Mapped(time.perf_counter() - began, images, points, finished=True)
    except EOFError:
        raise StageFailed(f"the process that mapped {window.name} died", where=window.name) from None
    finally:
        child.kill()
        child.join()


def _map(
    sender: Connection,
    graph: Path,
    window: Window,
    settings: MapperSettings,
    seed: int,
    threads: int,
    start: Path | None,
) -> None:
    import pycolmap

    pycolmap.logging.minloglevel = pycolmap.logging.ERROR.value
    from core.sparse.cases import Case, run_case

    sender.send("ready")
    model: Any = pycolmap.Reconstruction(start / "model") if start is not None else None
    result = run_case(Case(graph, window.start, window.end, settings, seed, threads), model)
    sender.send((result.stats.registered_images, result.stats.points3D))
