"""What one application keeps in memory between requests; everything that matters is in the database."""

from __future__ import annotations

from dataclasses import dataclass, field

from fastapi import Request
from prometheus_client import CollectorRegistry

from api.events import EventFeed
from api.fetching import Fetches
from api.probing import Prober
from api.resource import Resources
from api.services import Services
from api.watching import Watcher
from store.keys import KeyRing
from store.request_rate import RequestRate
from store.uploads import Digests
from store.web_sessions import WebSessions


@dataclass(frozen=True)
class State:
    """Caches and locks of this process."""

    services: Services
    keys: KeyRing
    resources: Resources
    watcher: Watcher
    prober: Prober
    registry: CollectorRegistry
    rate: RequestRate
    sessions: WebSessions
    feed: EventFeed
    digests: Digests
    fetches: Fetches
    in_flight: set[tuple[str, str]] = field(default_factory=set)
    """(owner, Idempotency-Key) of requests that are being answered."""


def state_of(request: Request) -> State:
    """The state of the application that a request came to."""
    state: State = request.app.state.bladeatlas
    return state
