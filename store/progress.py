"""How far a plan is: a weighted share over its stages, from counts alone."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from store.graph import Graph

STEP = 0.005
"""Progress is shown in steps of this, so that remembering the highest costs few writes."""


@dataclass(frozen=True)
class StageCount:
    """The tasks of one stage as far as they are known."""

    total: int
    over: int
    """Ended, in whatever way."""
    running: float = 0.0
    """Sum of the shares of running tasks."""

    @property
    def share(self) -> float:
        """How far the stage is, in [0, 1]."""
        return min(1.0, (self.over + self.running) / self.total) if self.total else 0.0


def stage_weights(graph: Graph, present: Mapping[str, StageCount]) -> dict[str, float]:
    """Weight of every stage that this plan has or may still get; one that was passed by has none."""
    names = list(graph.stages)
    reached = max((names.index(name) for name in present), default=-1)
    return {
        name: graph.stages[name].weight for position, name in enumerate(names) if name in present or position > reached
    }


def plan_share(graph: Graph, counts: Mapping[str, StageCount]) -> float:
    """How far the plan is, in [0, 1]."""
    weights = stage_weights(graph, counts)
    total = sum(weights.values())
    if not total:
        return 0.0
    done = sum(weight * counts[name].share for name, weight in weights.items() if name in counts)
    return min(1.0, done / total)


def in_steps(share: float) -> float:
    """`share` rounded down to `STEP`."""
    return int(share / STEP + 1e-9) * STEP
