"""Which program and engines answer, what waits, who works; and the same for Prometheus."""

from __future__ import annotations

from collections.abc import Iterator
from datetime import datetime

from fastapi import APIRouter, Request, Response
from prometheus_client import CONTENT_TYPE_LATEST, generate_latest
from prometheus_client.core import GaugeMetricFamily, Metric
from prometheus_client.registry import Collector
from pydantic import BaseModel, ConfigDict, Field

from api.auth import Reader
from api.limits import free_bytes
from api.problems import responses
from api.services import Services
from api.state import state_of
from core.versions import engine_versions, program_version
from store.monitoring import count_all

router = APIRouter(tags=["system"])


class QueueItem(BaseModel):
    """One queue."""

    runnable: int = Field(description="tasks that wait for a worker")
    leased: int = Field(description="tasks that run")


class WorkerItem(BaseModel):
    """A process that runs tasks."""

    name: str
    host: str
    queues: list[str]
    started_at: datetime
    seen_at: datetime


class System(BaseModel):
    """Versions of the program and of the engines installed beside it; queues and workers."""

    model_config = ConfigDict(
        json_schema_extra={
            "example": {
                "version": "0.1.0",
                "engines": {"pycolmap": "4.2.1", "torch": "2.13.0"},
                "inspections": {"running": 1},
                "queues": {"cpu": {"runnable": 4, "leased": 2}},
                "workers": [],
            }
        }
    )

    version: str = Field(description="version of this program")
    engines: dict[str, str] = Field(description="package and its version, or `not installed`")
    inspections: dict[str, int] = Field(description="inspections of everybody by state")
    queues: dict[str, QueueItem]
    workers: list[WorkerItem] = Field(description="seen within the last minute")


@router.get("/v1/system", summary="Versions, queues, workers", responses=responses(401, 503))
def system(request: Request, caller: Reader) -> System:
    """Versions come from package metadata; no engine is loaded. Nothing here names an inspection."""
    counts = count_all(state_of(request).services.db)
    queues: dict[str, QueueItem] = {}
    for (queue, state), number in counts.tasks.items():
        item = queues.setdefault(queue, QueueItem(runnable=0, leased=0))
        setattr(item, state, number)
    return System(
        version=program_version(),
        engines=engine_versions(),
        inspections=dict(counts.inspections),
        queues=queues,
        workers=[WorkerItem.model_validate(vars(worker)) for worker in counts.workers],
    )


@router.get(
    "/metrics",
    tags=["health"],
    summary="Figures for Prometheus",
    response_class=Response,
    responses={
        200: {"content": {"text/plain": {"schema": {"type": "string"}, "example": "bladeatlas_uploads 0.0\n"}}},
        **responses(401, 503),
    },
)
def metrics(request: Request, caller: Reader) -> Response:
    """Counts from the database, so every API process says the same; durations of this process's requests."""
    return Response(generate_latest(state_of(request).registry), media_type=CONTENT_TYPE_LATEST)


class ServiceCollector(Collector):
    """Looks at the database when Prometheus asks."""

    def __init__(self, services: Services) -> None:
        self._services = services

    def describe(self) -> Iterator[Metric]:
        """Give no metric, because registering the collector must not ask the database."""
        return iter(())

    def collect(self) -> Iterator[Metric]:
        """Read the counts and times of all queues from the database and give them as metrics."""
        counts = count_all(self._services.db)
        inspections = GaugeMetricFamily("bladeatlas_inspections", "inspections by state", labels=["state"])
        for state, number in counts.inspections.items():
            inspections.add_metric([state], number)
        tasks = GaugeMetricFamily("bladeatlas_tasks", "tasks that wait or run", labels=["queue", "state"])
        for (queue, state), number in counts.tasks.items():
            tasks.add_metric([queue, state], number)
        attempts = GaugeMetricFamily("bladeatlas_attempts", "attempts ever, by outcome", labels=["outcome"])
        for outcome, number in counts.attempts.items():
            attempts.add_metric([outcome], number)
        yield from (inspections, tasks, attempts)
        yield GaugeMetricFamily("bladeatlas_uploads", "unfinished uploads", value=counts.uploads)
        yield GaugeMetricFamily("bladeatlas_workers", "workers seen within a minute", value=len(counts.workers))
        yield GaugeMetricFamily("bladeatlas_oldest_queued_seconds", "longest wait", value=counts.oldest_queued_s)
        yield GaugeMetricFamily("bladeatlas_free_bytes", "free disk space", value=free_bytes(self._services))
