"""`bladeatlas serve`: the API, and the runners beside it when no broker is configured."""

from __future__ import annotations

import argparse
import signal
import uuid
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from functools import partial

import uvicorn
from fastapi import FastAPI
from filelock import FileLock, Timeout

from api.app import create_app
from api.connections import config_of, listeners_on
from api.services import make_services
from api.trust import is_loopback_address
from core.errors import BadInput, BladeAtlasError
from store import json_log
from store.announcing import Announcements
from store.db import Database
from store.environment import deployment_settings
from store.factory import open_artifacts, open_database
from store.graph import Graph, load_graph
from store.housekeeping import Retention
from store.keys import Keys
from store.settings import DeploymentSettings, prefix_path
from worker.broker import TaskQueue
from worker.cleaner import UploadCleaner
from worker.loop import PollingRunners, WorkerService, say_confinement
from worker.periodic import Periodic

_log = json_log.logger("bladeatlas.server")
_DRAIN_S = 5
"""How long requests may go on after the server was told to stop."""


def command(parsed: argparse.Namespace) -> int:
    """Serve until SIGTERM or SIGINT; returns the exit code."""
    if parsed.workers is not None and parsed.workers < 1:
        raise BadInput(f"{parsed.workers} workers; at least 1", where="--workers")
    settings = deployment_settings()
    if parsed.no_auth:
        settings = settings.model_copy(update={"no_auth": True})
    if parsed.root_path is not None:
        settings = settings.model_copy(update={"root_path": _prefix(parsed.root_path)})
    json_log.configure()
    say_confinement()
    with _alone(settings) as identity:
        database = open_database(settings)
        try:
            _refuse_strangers(database, parsed.host, settings)
            graph = load_graph(settings.graph)
            with ExitStack() as running:
                wake = _background(running, settings, database, graph, identity, parsed.workers)
                application = _application(settings, database, graph, wake, identity)
                _listen(application, settings, parsed.host, parsed.port)
        finally:
            database.close()
    return 0


def _prefix(text: str) -> str:
    try:
        return prefix_path(text)
    except ValueError as error:
        raise BadInput(str(error), where="--root-path") from None


def _application(
    settings: DeploymentSettings, database: Database, graph: Graph, wake: Callable[[str], None], identity: str
) -> FastAPI:
    """The API over these services; `wake` is called with an inspection's id after its commit."""
    services = make_services(settings, database, open_artifacts(settings), wake=wake, graph=graph, name=identity)
    # The lock on the folder says that the process which fetched under this name is gone.
    services.transfers.take_over(identity)
    return create_app(services)


@contextmanager
def _alone(settings: DeploymentSettings) -> Iterator[str]:
    """The server's name, the same after every restart; no two servers share a data folder.

    Raises:
        BadInput: another server uses the folder, or it cannot be written.
    """
    folder = settings.data_dir.absolute()
    path = folder / "server.lock"  # holds the name as well
    lock = FileLock(path, blocking=False, fallback_to_soft=False)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        held = lock.acquire()
    except Timeout:
        raise BadInput(f"another server uses '{folder}'", code="folder_in_use", where="data_dir") from None
    except OSError as error:
        raise BadInput(f"the data folder '{folder}' cannot be written: {error.strerror}", where="data_dir") from None
    with held:
        name = path.read_text(encoding="utf-8").strip()
        if not name:
            name = f"serve-{uuid.uuid4().hex[:12]}"
            path.write_text(name, encoding="utf-8")
        yield name


def _refuse_strangers(database: Database, host: str, settings: DeploymentSettings) -> None:
    """As long as no key was ever made anybody may do anything, so only this machine may call, unless that is wanted.

    Raises:
        BadInput: `host` is not loopback and no key was ever made.
    """
    keys = Keys(database)
    if settings.no_auth:
        _log.warning("no_auth", host=host, meaning="whoever reaches this server may read and submit without a key")
    elif not keys.ever_made():
        if host != "localhost" and not is_loopback_address(host):
            message = f"no API key was ever made, so the server binds only to this machine, not to '{host}'"
            raise BadInput(message, code="no_keys", where="--host")
    elif not keys.any_valid():
        _log.warning(
            "no_valid_key", meaning="every key was revoked or has expired: all requests are refused until one is made"
        )


def _background(
    running: ExitStack,
    settings: DeploymentSettings,
    database: Database,
    graph: Graph,
    identity: str,
    workers: int | None,
) -> Callable[[str], None]:
    """Start what runs beside the API; returns what to call when an inspection has work."""
    uploads = UploadCleaner(Retention(database), settings.folder("uploads"), settings.stale_s)
    cleaning = Periodic("uploads", uploads.round, settings.sweep_s)
    _run(running, cleaning)
    if settings.broker_url:
        queue = TaskQueue(settings.broker(), settings.visibility_timeout_s)
        sender = Periodic("queue", partial(queue.announce, Announcements(database)), settings.sweep_s)
        _run(running, sender)
        return lambda _inspection_id: sender.nudge()
    service = WorkerService(settings, database, open_artifacts(settings), graph, identity)
    # The lock on the folder says that the process which held these is gone.
    freed = service.plan.take_over_all(f"{identity}/")
    service.publishing.take_over(identity)
    service.results.sweep(service.plan.leased)
    _log.info("runners_ready", owner=identity, leases_taken_over=freed)
    runners = PollingRunners(service, workers or settings.worker_count())
    _run(running, service)
    _run(running, runners)
    return lambda _inspection_id: runners.wake()


def _run(running: ExitStack, part: Periodic | WorkerService | PollingRunners) -> None:
    part.start()
    running.callback(part.stop)


def _listen(application: FastAPI, settings: DeploymentSettings, host: str, port: int) -> None:
    config = config_of(
        application,
        settings,
        log_config=None,
        access_log=False,
        timeout_graceful_shutdown=_DRAIN_S,
    )
    server = uvicorn.Server(config)
    # uvicorn raises the signal once more at its end: by then it has done its work, and runners are still to be stopped.
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, lambda *_: None)
    with ExitStack() as listening:
        sockets = [listening.enter_context(one) for one in listeners_on(host, port)]
        _log.info("listening", host=host, port=sockets[0].getsockname()[1])
        server.run(sockets)
    if not server.started:
        raise BladeAtlasError("the server could not start; the lines above say why", where="serve")
