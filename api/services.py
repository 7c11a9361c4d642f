"""What the routes work with; made once, handed to `create_app`, so that no route knows how anything is deployed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from store.account_models import DEFAULT_ACCOUNT
from store.admission import Admission
from store.db import Database
from store.factory import open_artifacts, open_database
from store.files import ArtifactStore
from store.graph import CORE_GRAPH, Graph, load_graph
from store.inspections import Inspections
from store.leasing import unique_name
from store.logs import InspectionLogs
from store.plan import Plan
from store.settings import DeploymentSettings
from store.transfers import Transfers
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
    name: str = field(default_factory=unique_name)
    """Holder of its leases; unique, or kept over restarts by whoever can vouch that the old process is gone."""

    @property
    def inspections(self) -> Inspections:
        """The repository of inspections."""
        return Inspections(self.db, self.graph)

    @property
    def plan(self) -> Plan:
        """The plan of tasks, through which inspections are cancelled."""
        return Plan(self.db, self.graph, self.settings.lease_s, self.settings.max_attempts)

    @property
    def uploads(self) -> Uploads:
        """Resumable uploads; their bytes lie on this machine until an inspection takes them."""
        return Uploads(self.db, self.settings.folder("uploads"), self.settings.upload_hours)

    @property
    def transfers(self) -> Transfers:
        """Inputs that are fetched by URL."""
        return Transfers(self.db, self.settings.lease_s)

    @property
    def admission(self) -> Admission:
        """Limits on what may begin."""
        return Admission(self.db, self.settings)

    def reuse_account(self, owner: str) -> str:
        """The account whose results alone a new inspection of `owner` may take up; empty: those that all share."""
        shares = self.settings.share_results or owner == DEFAULT_ACCOUNT
        return "" if shares else owner

    def link(self, path: str) -> str:
        """A path of this server as clients ask for it: below the prefix, where there is one."""
        return self.settings.root_path + path

    @property
    def logs(self) -> InspectionLogs:
        """Logs, which lie beside the artifacts."""
        return InspectionLogs(self.artifacts)


def make_services(
    settings: DeploymentSettings,
    db: Database,
    artifacts: ArtifactStore,
    *,
    wake: Callable[[str], None],
    graph: Graph = CORE_GRAPH,
    name: str = "",
) -> Services:
    """Services over a database and an artifact store that are open already."""
    settings.folder("uploads").mkdir(parents=True, exist_ok=True)
    return Services(settings, db, artifacts, _results(settings), wake, graph, name or unique_name())


def services_from(settings: DeploymentSettings) -> Services:
    """Services from the environment: of a process that only answers requests, while runners elsewhere poll."""
    db = open_database(settings)
    return make_services(settings, db, open_artifacts(settings), wake=_nobody, graph=load_graph(settings.graph))


def _results(settings: DeploymentSettings) -> ArtifactStore:
    """The part of the artifact store that holds results."""
    root = settings.artifacts()
    if isinstance(root, str):
        return ArtifactStore(f"{root.rstrip('/')}/results", **settings.storage_options())
    return ArtifactStore(root / "results")


def _nobody(inspection_id: str) -> None:
    """Wake nobody: runners poll the plan, and the sweeper of a queue finds what is runnable."""
