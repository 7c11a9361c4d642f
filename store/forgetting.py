"""Results that shall be computed again: taken out of memory, so that a new plan does not find them."""

from __future__ import annotations

from sqlalchemy import select

from core.errors import BadInput
from store.inspections import Inspections
from store.models import ACTIVE_INSPECTION, Inspection, Task


def forget_from(inspections: Inspections, inspection_id: str, stage: str) -> list[str]:
    """Forget the results of `stage` and of all that follow it in this plan.

    Returns:
        Their paths in the result store; whoever calls removes the files, afterwards and never before.

    Raises:
        BadInput: `conflict` when another inspection that is not over builds on one of them.
    """
    stages = inspections.stages_from(inspection_id, stage)
    own = [task for task in inspections.tasks(inspection_id) if task.stage in stages and task.fingerprint]
    fingerprints = {task.fingerprint for task in own if task.fingerprint}
    shared = (
        select(Task.id)
        .join(Inspection, Inspection.id == Task.inspection_id)
        .where(Task.inspection_id != inspection_id, Task.fingerprint.in_(fingerprints))
        .where(Inspection.state.in_(ACTIVE_INSPECTION))
        .limit(1)
    )
    with inspections.db.read() as session:
        if session.scalar(shared) is not None:
            message = f"another inspection that is not over uses the same results of '{stage}'"
            raise BadInput(message, code="conflict", where="from_stage")
    paths = inspections.known_results()
    inspections.forget(fingerprints)
    return [paths[name] for name in sorted(fingerprints) if name in paths]
