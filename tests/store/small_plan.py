"""A plan small enough to follow by hand, and results made without running anything.

``split`` says how many ``part/N`` there are; each is optional; ``join`` takes them together, ``last`` follows.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from typing import Any

from core.fingerprint import digest_of
from core.graph import TaskSpec
from core.products.contract import Facts, Product
from core.settings import Settings
from core.stage_specs import StageSpec
from store.graph import Graph
from store.records import InputFiles, Lease, Result


def _expand(settings: Settings, facts: Mapping[str, Facts]) -> list[TaskSpec]:
    tasks = [TaskSpec("split")]
    if "split" not in facts:
        return tasks
    parts = [TaskSpec(f"part/{i}", ("split",), {"i": i}, optional=True) for i in range(int(facts["split"]["n"]))]
    keys = tuple(part.key for part in parts)
    return [*tasks, *parts, TaskSpec("join", ("split", *keys)), TaskSpec("last", ("join",))]


GRAPH = Graph(
    {
        "split": StageSpec("split", 1, "nowhere:run", Product, ("matching.window",), reads_video=True),
        "part": StageSpec("part", 1, "nowhere:run", Product, ("mapper.min_model_size",), fan_out=True),
        "join": StageSpec("join", 1, "nowhere:run", Product, ("mesh.poisson_trim",)),
        "last": StageSpec("last", 1, "nowhere:run", Product, ("timeline.radius_fraction",), reads_annotations=True),
    },
    _expand,
    serves_from=("join",),
)

INPUT = InputFiles("/v.mp4", hashlib.sha256(b"v").hexdigest(), "/a.json", hashlib.sha256(b"a").hexdigest())
FILES = (INPUT,)


def result_for(lease: Lease, facts: Facts | None = None, **more: Any) -> Result:
    """What the stage of a lease would have made."""
    found = {"split": {"n": 3}}.get(lease.stage, {"value": len(lease.inputs)}) if facts is None else facts
    return Result(
        fingerprint=lease.fingerprint,
        stage=lease.stage,
        digest=digest_of({"facts": found, "key": lease.key}),
        facts=found,
        path=f"{lease.stage}/{lease.fingerprint}",
        seconds=1.5,
        peak_rss_bytes=1000,
        **more,
    )
