"""All of Celery: a worker of a distributed system, fed by the broker, or asking the database when there is none.

A Celery job is one task of a plan and is named so: ``bladeatlas.coarse("INSPECTION", "seg_006_0120_0300")``. Its
message says that the task can start; whether it can, the database knows. So a message that comes twice finds nothing
to do, and ends as ignored; one that was lost is sent again (`store.announcing`).
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Collection, Sequence
from functools import partial
from typing import Any

from celery import Celery, signals
from celery.exceptions import Ignore, Retry
from kombu import Exchange
from kombu import Queue as BrokerQueue

from core.states import AttemptOutcome, Queue
from core.task_key import key_of, part_of, stage_of, submodel_of
from store.announcing import Announcements
from store.db import Database
from store.factory import open_artifacts
from store.graph import load_graph
from store.json_log import logger
from store.leasing import unique_name
from store.records import Lease
from store.retry import retried_until
from store.settings import DeploymentSettings
from worker.loop import ConcurrencyLimit, PollingRunners, WorkerService
from worker.periodic import Periodic
from worker.runner import Ending, Heartbeat, ids

_PREFIX = "bladeatlas."
_CONNECT_S = 4.0
_AGAIN = (AttemptOutcome.RETRIED, AttemptOutcome.RELEASED)
_IGNORED_EVENT = "task-ignored"
"""Celery has no event for it, and without one a monitor shows an ignored job as running for ever."""

Run = Callable[[str, str], Ending | None]
"""Runs the task of an inspection with a key; None when it cannot start, or not any more."""


class JobFailed(Exception):
    """The stage of this job failed; what follows from that for the inspection, the plan says."""


_log = logger("bladeatlas.worker")


class TaskQueue:
    """The broker as senders and workers see it."""

    def __init__(self, broker_url: str, visibility_timeout_s: float) -> None:
        self._app = Celery("bladeatlas", broker=broker_url, set_as_current=False)
        # The nameless exchange needs no bindings: a broker that lost its memory delivers at once again.
        self._queues = {
            name: BrokerQueue(f"{_PREFIX}{name}", Exchange(""), routing_key=f"{_PREFIX}{name}") for name in Queue
        }
        self._app.conf.update(
            broker_connection_retry_on_startup=True,
            broker_connection_max_retries=None,
            broker_connection_timeout=_CONNECT_S,
            broker_transport_options=_transport_options(broker_url, visibility_timeout_s),
            task_acks_late=True,
            task_create_missing_queues=False,
            task_default_queue=self._queues[Queue.CPU].name,
            task_ignore_result=True,
            task_queues=list(self._queues.values()),
            task_send_sent_event=True,
            worker_enable_remote_control=True,
            worker_hijack_root_logger=False,
            worker_prefetch_multiplier=1,
            worker_redirect_stdouts=False,
            worker_send_task_events=True,
        )

    def announce(self, announcements: Announcements, overdue_s: float | None = None) -> int:
        """Send the messages that are wanted now, in order; returns how many. `overdue_s`: see `Announcements.choose`.

        A broker that is away is noticed before tasks are noted as announced.
        """
        with self._app.connection_for_write() as connection:
            connection.ensure_connection(max_retries=1, timeout=_CONNECT_S)
            chosen = announcements.choose(overdue_s)
            for one in chosen:
                part, submodel = part_of(one.key), submodel_of(one.key)
                self._app.send_task(
                    _PREFIX + stage_of(one.key),
                    args=(one.inspection_id, part) if part else (one.inspection_id,),
                    kwargs={"piece": submodel} if submodel else {},
                    queue=self._queues[one.queue],
                    connection=connection,
                    retry=False,
                )
        return len(chosen)

    def work(
        self,
        run: Run,
        stages: Collection[str],
        name: str,
        queues: Sequence[str],
        workers: int,
        on_stop: Callable[[], None],
    ) -> int:
        """Take messages until the process is told to stop; returns its exit code.

        Args:
            run: called in one of `workers` threads.
            stages: names of all stages that a message may name.
            name: of this worker, for the broker.
            queues: that it serves.
            workers: messages side by side.
            on_stop: called when SIGTERM or SIGINT came: what runs should come to an end now.
        """
        # Celery leaves the logs alone when somebody listens to this.
        signals.setup_logging.connect(_leave_logging, weak=False)
        signals.worker_shutting_down.connect(lambda **_: on_stop(), weak=False)
        worker = self._app.Worker(
            # Threads: they only wait for child processes, and a signal reaches the main thread at once.
            pool="threads",
            concurrency=workers,
            queues=[self._queues[Queue(name)].name for name in queues],
            hostname=name,
            quiet=True,
            without_gossip=True,
            without_mingle=True,
        )

        def tell_ignored(job_id: str) -> None:
            dispatcher = worker.consumer.event_dispatcher
            if dispatcher is not None:  # else it is connecting again
                dispatcher.send(_IGNORED_EVENT, uuid=job_id)

        for stage in stages:
            self._register(stage, run, tell_ignored)
        worker.start()
        return int(worker.exitcode or 0)

    def _register(self, stage: str, run: Run, tell_ignored: Callable[[str], None]) -> None:
        """Let messages name a stage."""

        def job(celery_task: Any, inspection_id: str, part: str = "", piece: int = 0) -> str:
            ending = run(inspection_id, key_of(stage, piece, part))
            if ending is None or ending.outcome == AttemptOutcome.REFUSED:
                tell_ignored(celery_task.request.id)
                raise Ignore
            return _as_celery_says(ending)

        self._app.task(job, name=_PREFIX + stage, bind=True, throws=(JobFailed,))


def _as_celery_says(ending: Ending) -> str:
    """End a job as what became of its task: successful with the outcome, failed, or to be tried again."""
    said = f"{ending.error.code}: {ending.error.message}" if ending.error else str(ending.outcome)
    if ending.outcome == AttemptOutcome.FAILED:
        raise JobFailed(said)
    if ending.outcome in _AGAIN:
        # Only the state: the plan decides when, and then another message comes.
        raise Retry(said, exc=JobFailed(said))
    return said


def _leave_logging(**_more: object) -> None:
    """Logs are set up already."""


def _transport_options(broker_url: str, visibility_timeout_s: float) -> dict[str, Any]:
    if not broker_url.startswith("redis"):
        return {}
    return {
        "visibility_timeout": visibility_timeout_s,
        # Look for messages past it at every turn of ten seconds; by default Kombu does at every tenth turn only.
        "unacked_restore_throttle": 1,
        "socket_connect_timeout": _CONNECT_S,
        "socket_keepalive": True,
    }


def run_worker(settings: DeploymentSettings, database: Database, queues: Sequence[str], workers: int) -> int:
    """Run tasks until SIGTERM or SIGINT; returns the exit code.

    Args:
        queues: of ``cpu`` and ``gpu``.
        workers: tasks side by side.
    """
    # What is not fed by messages must not count among those who wait for some.
    concurrency = workers if settings.broker_url else 0
    service = WorkerService(
        settings,
        database,
        open_artifacts(settings),
        load_graph(settings.graph),
        unique_name(),
        tuple(queues),
        concurrency,
    )
    _log.info(
        "worker_started", name=service.name, queues=list(queues), workers=workers, broker=bool(settings.broker_url)
    )
    run = _fed_by_broker if settings.broker_url else _asking
    code = run(service, workers)
    _log.info("worker_stopped", name=service.name)
    return code


def _asking(service: WorkerService, workers: int) -> int:
    stopped = threading.Event()
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, lambda *_: stopped.set())
    runners = PollingRunners(service, workers)
    service.start()
    runners.start()
    stopped.wait()
    runners.stop()
    service.stop()
    return 0


def _fed_by_broker(service: WorkerService, workers: int) -> int:
    settings, plan = service.settings, service.plan
    queue = TaskQueue(settings.broker(), settings.visibility_timeout_s)
    announcements = Announcements(service.database)

    def announce(overdue_s: float | None = None) -> None:
        service.report()  # else the first messages wait until somebody knows how many tasks this worker takes
        queue.announce(announcements, overdue_s)

    sender = Periodic("queue", announce, settings.sweep_s)
    again = Periodic("queue_again", partial(announce, settings.sweep_s), settings.sweep_s)
    service.on_end = sender.nudge
    runner = service.runner()
    heartbeat = Heartbeat(runner, settings.heartbeat_s)
    limit = ConcurrencyLimit(workers, runner.interrupted, quiet_s=settings.sweep_s)

    def leased(lease: Callable[[], Lease | None]) -> Lease | None:
        return retried_until(runner.interrupted, plan.db, lease)

    def run_next(overdue_s: float | None) -> bool:
        lease = leased(lambda: plan.lease(service.name, queues=service.queues, overdue_s=overdue_s))
        if lease is not None:
            _log.warning("ran_without_message", **ids(lease))
            runner.run(lease)
        return lease is not None

    def run_named(inspection_id: str, key: str) -> Ending | None:
        lease = leased(lambda: plan.lease_named(service.name, inspection_id, key))
        return runner.run(lease) if lease is not None else None

    def on_message(inspection_id: str, key: str) -> Ending | None:
        ending = limit.on_message(lambda: run_named(inspection_id, key))
        if ending is None:
            sender.nudge()  # another message may take the place of this one
        return ending

    # A broker that stops delivering to this worker costs time, not the job.
    helpers = [
        Periodic("without_message", partial(limit.without_message, run_next), settings.sweep_s) for _ in range(workers)
    ]

    def keep() -> None:
        try:
            heartbeat.run()
        except Exception:  # noqa: BLE001 - the border of a thread: logged, and what follows is said below
            # Without heartbeats every lease is lost: better no worker than one that works for nothing.
            _log.exception("heartbeat_failed")
            runner.interrupted.set()
            signal.raise_signal(signal.SIGTERM)

    thread = threading.Thread(target=keep, name="heartbeat", daemon=True)
    thread.start()
    service.start()
    for part in (sender, again, *helpers):
        part.start()
    try:
        stages = service.plan.graph.stages
        return queue.work(on_message, stages, service.name, service.queues, workers, runner.interrupted.set)
    finally:
        runner.interrupted.set()
        for part in (*helpers, again, sender):
            part.stop()
        heartbeat.stopped.set()
        thread.join()
        service.stop()
