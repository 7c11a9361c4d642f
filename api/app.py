"""The HTTP application: `uvicorn --factory api.app:create_app`."""

from __future__ import annotations

import sys

from fastapi import Depends, FastAPI
from prometheus_client import CollectorRegistry

from api import openapi, problems, transport
from api.auditing import Auditor
from api.events import EventFeed
from api.fetching import Fetches
from api.middleware import RequestMetrics, RequestMiddleware, known_query
from api.prefix import PrefixMiddleware
from api.probing import Prober
from api.resource import Resources
from api.routes import (
    accounts,
    actions,
    artifacts,
    audit,
    events,
    exports,
    frames,
    health,
    inspections,
    keys,
    links,
    options,
    pages,
    report,
    reviews,
    row,
    session,
    stages,
    system,
    tables,
    uploads,
    viewer,
    webhooks,
)
from api.services import Services, services_from
from api.state import State
from api.trust import TrustMiddleware
from api.watching import Watcher
from core.errors import BadInput
from core.versions import program_version
from store.audit import AuditLog
from store.environment import deployment_settings
from store.events import Events
from store.keys import KeyRing, Keys
from store.request_rate import RequestRate
from store.uploads import Digests
from store.web_sessions import WebSessions

_ROUTERS = (
    *(health, pages, system, options, uploads, inspections, actions, row, stages, tables, reviews),
    *(artifacts, viewer, report, frames, session, keys, accounts, audit, events, links, webhooks, exports),
)


def create_app(services: Services | None = None) -> FastAPI:
    """Make the application with its routes and error handlers.

    Without `services` they are made from the environment, tables included; wrong settings end the process with
    exit code 2.
    """
    app = FastAPI(
        title="BladeAtlas",
        version=program_version(),
        summary="Borescope video and its annotations in, a 3D surface of the blades with every defect on it out.",
        responses={
            "default": {"model": problems.Problem, "description": "Any error, as application/problem+json (RFC 9457)"}
        },
        dependencies=[Depends(known_query)],
        generate_unique_id_function=openapi.name_of_call,
        # `api.routes.pages` serves these, without a foreign script.
        openapi_url=None,
        docs_url=None,
        redoc_url=None,
        # A trailing slash names nothing: a redirect would lose the body of a form.
        redirect_slashes=False,
    )
    app.state.bladeatlas = state = _state(services or _from_environment())
    problems.install(app)
    openapi.install(app)
    # The last one added is the first that sees a request: refusals are named and counted too.
    settings = state.services.settings
    app.add_middleware(TrustMiddleware, keys=state.keys, trusted_hosts=settings.host_names(), no_auth=settings.no_auth)
    transport.install(app, settings.origins())
    app.add_middleware(
        RequestMiddleware, metrics=RequestMetrics(state.registry), auditor=Auditor(AuditLog(state.services.db))
    )
    if settings.root_path:
        app.add_middleware(PrefixMiddleware, prefix=settings.root_path)
    for module in _ROUTERS:
        app.include_router(module.router)
    return app


def _from_environment() -> Services:
    try:
        return services_from(deployment_settings())
    except BadInput as error:  # the server that calls the factory would show a traceback and exit code 1
        sys.stderr.write(f"bladeatlas: {error.message}\n")
        raise SystemExit(2) from None


def _state(services: Services) -> State:
    registry = CollectorRegistry()
    registry.register(system.ServiceCollector(services))
    resources, digests = Resources(services), Digests()
    return State(
        services=services,
        keys=KeyRing(Keys(services.db)),
        resources=resources,
        watcher=Watcher(resources.snapshot),
        prober=Prober(services.settings),
        registry=registry,
        rate=RequestRate(services.db, services.settings),
        sessions=WebSessions(services.db),
        feed=EventFeed(Events(services.db).last, services.settings),
        digests=digests,
        fetches=Fetches(services, digests),
    )
