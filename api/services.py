"""What the routes work with; made once, handed to `create_app`, so that no route knows how anything is deployed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from store.artifacts import ArtifactStore
from store.db import Database, open_sqlite, upgrade
from store.graph import CORE_GRAPH, Graph
from store.inspections import Inspections
from store.logs import InspectionLogs
from store.plan import Plan
from store.settings import DeploymentSettings
from store.uploads import Uploads


@dataclass(frozen=True)
class Services:
    """The deployment as the HTTP side sees it."""

    settings: DeploymentSettings
    db: Database
    artifacts: ArtifactStore
    """Published files, and inputs under ``inputs/<sha256>/``."""
    results: ArtifactStore
    """Stage results, ``<stage>/<fingerprint>/...``."""
    wake: Callable[[str], None]
    """Called with an inspection's id after a commit. It never raises: the sweeper repairs what is lost."""
    graph: Graph = CORE_GRAPH

    @property
    def inspections(self) -> Inspections:
        """Inspections as a whole."""
        return Inspections(self.db, self.graph)

    @property
    def plan(self) -> Plan:
        """Cancellation."""
        return Plan(self.db, self.graph, self.settings.lease_s, self.settings.max_attempts)

    @property
    def uploads(self) -> Uploads:
        """Resumable uploads; their bytes lie on this machine until an inspection takes them."""
        return Uploads(self.db, self.settings.folder("uploads"), self.settings.upload_hours)

    @property
    def logs(self) -> InspectionLogs:
        """Logs: local files beside a local store, objects beside a remote one."""
        if self.settings.artifacts_url:
            return InspectionLogs(self.artifacts)
        return InspectionLogs(ArtifactStore(self.settings.folder("")))


def services_from(settings: DeploymentSettings) -> Services:
    """The services of a process that only answers requests; runners elsewhere find new work by themselves."""
    settings.folder("uploads").mkdir(parents=True, exist_ok=True)
    if settings.database_url:
        upgrade(settings.database())
        db = Database(settings.database())
    else:
        db = open_sqlite(settings.folder("bladeatlas.db"))
    return Services(
        settings=settings,
        db=db,
        artifacts=_store(settings, "artifacts"),
        results=_store(settings, "results"),
        wake=_nobody,
    )


def _store(settings: DeploymentSettings, name: str) -> ArtifactStore:
    if settings.artifacts_url:
        return ArtifactStore(f"{settings.artifacts_url.rstrip('/')}/{name}", **settings.artifacts_options)
    return ArtifactStore(settings.folder(name))


def _nobody(inspection_id: str) -> None:
    """Wake nobody: runners poll the plan, and the sweeper of a queue finds what is runnable."""
