"""Errors of the service as this program's own: the same classes, so that exit codes follow by themselves."""

from __future__ import annotations

from typing import Any

import httpx

from core.errors import BadInput, BladeAtlasError, ResourceError


class ServerProblem(BladeAtlasError):
    """The server answered with a problem that is nobody's input."""

    code = "server_problem"


def raise_problem(response: httpx.Response) -> None:
    """Raise what a response says, unless it says that all is well.

    Raises:
        BadInput: a 4xx that another request would have to fix.
        ResourceError: what may go well later: 429, 503, 507.
        ServerProblem: anything else.
    """
    if response.status_code < 400:
        return
    problem = _problem(response)
    detail = str(problem.get("detail") or f"the server answered {response.status_code} {response.reason_phrase}")
    code, where = str(problem.get("code") or "server_problem"), str(problem.get("where") or "")
    if problem.get("retryable"):
        raise ResourceError(detail, code=code, where=where)
    if 400 <= response.status_code < 500:
        raise BadInput(detail, code=code, where=where)
    named = f" (request {problem['request_id']})" if problem.get("request_id") else ""
    raise ServerProblem(detail + named, code=code, where=where)


def _problem(response: httpx.Response) -> dict[str, Any]:
    """The problem object, or nothing when something between us and the server answered."""
    try:
        found = response.json()
    except (ValueError, httpx.ResponseNotRead):
        return {}
    return found if isinstance(found, dict) else {}
