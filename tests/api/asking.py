"""Generated requests to a part of the calls that the service describes: each part is a file of tests of its own.

The parts run side by side, and each begins with a new service: what one of them deletes the other does not ask for.
"""

from __future__ import annotations

from collections.abc import Collection

import schemathesis

from api.app import create_app
from bench.service.generated import PATIENCE_S, Asked, ask_all, calls_of
from store.account_models import Scope
from store.keys import Keys
from tests.api.conftest import Backend
from tests.api.test_results import ROWS

REQUESTS = 60
"""To each call; those of a part take half a minute."""
OF_INSPECTIONS = "/v1/inspections"
"""The calls below it are one half of all, the others the other half."""


def hold_to_the_document(backend: Backend, *, of_inspections: bool, statuses: Collection[int]) -> None:
    """Ask the calls of one half, always the same; half of those about an inspection are about one that there is.

    Args:
        backend: whose service is asked.
        of_inspections: which half.
        statuses: that some answer must have: what is generated is neither all right nor all wrong.
    """
    key = Keys(backend.db).create("generated requests", scopes=tuple(Scope))[1]
    files = {"quality.json": b'{"verdict": "ok", "flags": []}', "mapping/timeline.csv": b"event_id\r\n"}
    one = backend.finished("one", files, **ROWS)
    asked = Asked({"Authorization": f"Bearer {key}"}, one)
    schema = schemathesis.openapi.from_asgi("/openapi.json", create_app(backend.services), timeout=PATIENCE_S)
    calls = [call for call in calls_of(schema) if call.path.startswith(OF_INSPECTIONS) == of_inspections]
    ask_all(calls, asked, REQUESTS, 0)
    assert asked.wrong == []
    assert len(asked.calls) == len(calls) > 25
    assert set(statuses) <= set(asked.statuses)
