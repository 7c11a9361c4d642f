"""States of an inspection, its tasks, stages, attempts and of an ended run; queues of tasks: each value once."""

from __future__ import annotations

from enum import StrEnum


class InspectionState(StrEnum):
    """Where an inspection is."""

    QUEUED = "queued"
    RUNNING = "running"
    CANCELLING = "cancelling"
    CANCELLED = "cancelled"
    SUCCEEDED = "succeeded"
    PARTIAL = "partial"
    """What was reached is served though a later stage failed."""
    FAILED = "failed"


class TaskState(StrEnum):
    """Where a task of a plan is."""

    WAITING = "waiting"
    RUNNABLE = "runnable"
    LEASED = "leased"
    SUCCEEDED = "succeeded"
    FAILED = "failed"
    SKIPPED = "skipped"
    CANCELLED = "cancelled"


class Queue(StrEnum):
    """What a task needs, which decides what workers may take it."""

    CPU = "cpu"
    GPU = "gpu"
    """Faster where there is an accelerator; runs without one as well."""


class StageState(StrEnum):
    """Where a stage is, summed over its tasks."""

    WAITING = "waiting"
    RUNNING = "running"
    SUCCEEDED = "succeeded"
    FAILED = "failed"
    SKIPPED = "skipped"
    CANCELLED = "cancelled"


class AttemptOutcome(StrEnum):
    """How a lease of a task ended; `RUNNING` while it has not."""

    RUNNING = "running"
    SUCCEEDED = "succeeded"
    REUSED = "reused"
    """The finished result was there already; the plan's history counts it as succeeded."""
    FAILED = "failed"
    RETRIED = "retried"
    RELEASED = "released"
    EXPIRED = "expired"
    CANCELLED = "cancelled"
    REFUSED = "refused"
    """The lease was lost before the result came."""


class RunState(StrEnum):
    """How a run ended."""

    SUCCEEDED = "succeeded"
    PARTIAL = "partial"
    FAILED = "failed"
    CANCELLED = "cancelled"
    INTERRUPTED = "interrupted"


def run_state(state: InspectionState) -> RunState:
    """How a run ended whose inspection is in `state`; one that is not over counts as failed."""
    ends = (InspectionState.SUCCEEDED, InspectionState.PARTIAL, InspectionState.CANCELLED)
    return RunState(state.value) if state in ends else RunState.FAILED
