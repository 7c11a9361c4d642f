"""Interleaved timing: what is compared takes turns, so that a busy machine slows all sides alike."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Timing:
    """Wall seconds of every run of one side, in order."""

    seconds: tuple[float, ...]

    @property
    def median(self) -> float:
        """Median in seconds."""
        return statistics.median(self.seconds)


def interleaved(sides: Mapping[str, Callable[[], object]], repeat: int) -> dict[str, Timing]:
    """Run all sides in turn, `repeat` times, and keep what each run took."""
    taken: dict[str, list[float]] = {name: [] for name in sides}
    for _ in range(repeat):
        for name, work in sides.items():
            start = time.perf_counter()
            work()
            taken[name].append(time.perf_counter() - start)
    return {name: Timing(tuple(seconds)) for name, seconds in taken.items()}


@dataclass(frozen=True)
class Row:
    """One line of a table: what was measured, its value, its unit, and what it is held against."""

    name: str
    value: float | int | str | None
    unit: str = ""
    target: str = ""

    def to_dict(self) -> dict[str, float | int | str | None]:
        """JSON form."""
        return {"name": self.name, "value": self.value, "unit": self.unit, "target": self.target}


@dataclass(frozen=True)
class Table:
    """The outcome of one comparison."""

    name: str
    title: str
    rows: tuple[Row, ...]

    def text(self) -> str:
        """For a terminal."""
        width = max(len(row.name) for row in self.rows)
        lines = [f"{self.name}: {self.title}"]
        for row in self.rows:
            value = "-" if row.value is None else f"{row.value:.4g}" if isinstance(row.value, float) else str(row.value)
            target = f"   ({row.target})" if row.target else ""
            lines.append(f"  {row.name:<{width}}  {value} {row.unit}".rstrip() + target)
        return "\n".join(lines)
