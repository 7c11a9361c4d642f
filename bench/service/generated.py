"""Requests that are generated from the service's own description, to every call that is in it.

Held of every answer: no 5xx, a status that the description names, and a body as it describes. A test asks a few of each
with a fixed seed (`tests/api/asking.py`); `bladeatlas-bench service` goes on for minutes.
"""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import httpx
import schemathesis
from hypothesis import HealthCheck, Phase, given, seed, settings
from schemathesis.checks import CheckContext, not_a_server_error
from schemathesis.core.failures import FailureGroup
from schemathesis.core.result import Ok
from schemathesis.core.transport import Response
from schemathesis.schemas import BaseSchema
from schemathesis.specs.openapi.checks import content_type_conformance, response_schema_conformance

from bench.service.deployment import Server, serving
from bench.speed.timing import Row, Table
from core.states import InspectionState
from store.account_models import Scope
from store.db import open_sqlite
from store.keys import Keys

SECONDS = 300.0
PATIENCE_S = 90.0
_OF_A_ROUND = 10
"""Requests to a call before the next has its turn."""
_READS, _LAST = ("get", "head", "options"), "delete"
_SHOWN = 5
_SAMPLES = Path("samples")

schemathesis.serializer.alias("application/offset+octet-stream", "application/octet-stream")


def status_is_named(_context: CheckContext, response: Response, case: schemathesis.Case[Any]) -> None:
    """The description names this status; its `default`, which is for clients, does not count."""
    if str(response.status_code) not in case.operation.definition.raw["responses"]:
        raise AssertionError(f"the status {response.status_code} is not described")


_CHECKS = (not_a_server_error, status_is_named, content_type_conformance, response_schema_conformance)


@dataclass
class Asked:
    """What came of the requests so far."""

    headers: Mapping[str, str]
    inspection_id: str
    """One that there is: half of the requests about an inspection are about it."""
    statuses: Counter[int] = field(default_factory=Counter)
    calls: Counter[str] = field(default_factory=Counter)
    wrong: list[str] = field(default_factory=list)

    def ask(self, case: schemathesis.Case[Any]) -> None:
        """Send one request and hold its answer against the description."""
        if len(str(case.path_parameters.get("inspection_id", "x"))) % 2 == 0:
            case.path_parameters["inspection_id"] = self.inspection_id
        answer = case.call(headers=dict(self.headers), timeout=PATIENCE_S)
        self.statuses[answer.status_code] += 1
        self.calls[case.operation.label] += 1
        try:
            case.validate_response(answer, checks=list(_CHECKS))
        except (AssertionError, FailureGroup) as failed:
            said = "; ".join(map(str, getattr(failed, "exceptions", (failed,))))
            self.wrong.append(f"{case.operation.label}: {said}\n{case.as_curl_command(headers=dict(self.headers))}")


def calls_of(schema: BaseSchema) -> list[Any]:
    """Every call: those that read first, those that take away last, so that the others find what they ask about.

    Raises:
        ValueError: the description has a mistake.
    """
    found = list(schema.get_all_operations())
    calls = [one.ok() for one in found if isinstance(one, Ok)]
    if len(calls) != len(found):
        raise ValueError("the description has a mistake")
    return sorted(calls, key=lambda call: (call.method == _LAST, call.method not in _READS))


def ask_all(calls: list[Any], asked: Asked, requests: int, number: int) -> None:
    """So many requests to each call; the same number gives the same requests."""
    for call in calls:

        @seed(number)
        @settings(
            max_examples=requests,
            deadline=None,
            suppress_health_check=list(HealthCheck),
            database=None,
            phases=(Phase.generate,),
        )
        @given(case=call.as_strategy())
        def ask(case: schemathesis.Case[Any]) -> None:
            asked.ask(case)

        ask()


def generated(folder: Path) -> Table:
    """Generated requests to a real server for five minutes, about an inspection of the toy graph among others."""
    with serving(folder / "data", {"BLADEATLAS_GRAPH": "bench.soak.toy:GRAPH"}) as server:
        headers = _key(folder / "data")
        asked = Asked(headers, _finished(server, headers))
        schema = schemathesis.openapi.from_url(f"{server.url}/openapi.json", headers=headers, timeout=PATIENCE_S)
        calls, end, number = calls_of(schema), time.monotonic() + SECONDS, 0
        while time.monotonic() < end:
            number += 1
            ask_all(calls, asked, _OF_A_ROUND, number)
            if httpx.get(f"{server.url}/v1/inspections/{asked.inspection_id}", headers=headers).is_error:
                asked.inspection_id = _finished(server, headers)  # it was deleted
    for wrong in asked.wrong[:_SHOWN]:
        print(wrong)
    worst = sum(count for status, count in asked.statuses.items() if status >= httpx.codes.INTERNAL_SERVER_ERROR)
    return Table(
        "generated requests",
        f"{len(calls)} calls in turn for {SECONDS:g} s, seeds 1 to {number}",
        (
            Row("requests", sum(asked.statuses.values())),
            Row("calls that were asked", len(asked.calls)),
            Row("answers 2xx", sum(count for status, count in asked.statuses.items() if status // 100 == 2)),
            Row("answers 5xx", worst, "", "0"),
            Row("answers that are not as described", len(asked.wrong), "", "0"),
        ),
    )


def _key(data: Path) -> dict[str, str]:
    database = open_sqlite(data / "bladeatlas.db")
    key = Keys(database).create("generated requests", scopes=tuple(Scope))[1]
    database.close()
    return {"Authorization": f"Bearer {key}"}


def _finished(server: Server, headers: Mapping[str, str]) -> str:
    """A new inspection of the sample that is over."""
    with (_SAMPLES / "turbine.mp4").open("rb") as video:
        sent = httpx.post(f"{server.url}/v1/inspections", files={"video": video}, headers=headers, timeout=60)
    own = f"{server.url}/v1/inspections/{sent.raise_for_status().json()['id']}"
    while True:
        resource: dict[str, Any] = httpx.get(f"{own}?wait=30", headers=headers, timeout=60).raise_for_status().json()
        if resource["state"] not in (InspectionState.QUEUED, InspectionState.RUNNING, InspectionState.CANCELLING):
            return str(resource["id"])
