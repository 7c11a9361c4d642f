"""The stage table of a finished run: seconds and peak memory."""

from __future__ import annotations

import json

from bench.speed.finished import FinishedRun
from bench.speed.timing import Row, Table


def compare(run: FinishedRun, *, threads: int, repeat: int) -> Table:
    """Seconds summed over a stage's tasks and the largest memory of one task, from `summary.json`.

    `threads` and `repeat` are those of the other comparisons; the run's own are in its summary.
    """
    summary = json.loads((run.out / "summary.json").read_text(encoding="utf-8"))
    rows = [
        Row(stage["name"], float(stage["seconds"]), f"s in {stage['tasks']} tasks, {_gib(stage['peak_rss_bytes'])} GiB")
        for stage in summary["stages"]
    ]
    peak = max(stage["peak_rss_bytes"] for stage in summary["stages"])
    total = sum(row.value for row in rows if isinstance(row.value, float))
    rows += [
        Row("sum over tasks", total, "s"),
        Row("largest memory of a task", float(_gib(peak)), "GiB", "under 4"),
    ]
    return Table("stages", f"preset {summary['preset']}, seconds summed over tasks that ran side by side", tuple(rows))


def _gib(size: int) -> str:
    return f"{size / 2**30:.2f}"
