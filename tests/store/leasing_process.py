"""A process that takes and completes leases until a plan is over, and writes down what it took."""

from __future__ import annotations

import sys
from pathlib import Path

from store.db import Database
from store.inspections import Inspections
from store.plan import Plan
from tests.store.small_plan import GRAPH, result_for


def main(url: str, journal: Path) -> None:
    plan = Plan(Database(url), GRAPH)
    inspections = Inspections(plan.db, GRAPH)
    lines = []
    while inspections.get("one").state in ("queued", "running"):
        lease = plan.lease(str(journal))
        if lease is not None:
            facts = {"n": 25} if lease.stage == "split" else None
            accepted = plan.complete(lease, result_for(lease, facts))
            lines.append(f"{lease.task_id} {lease.fence} {lease.key} {accepted}")
    journal.write_text("\n".join(lines))


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]))
