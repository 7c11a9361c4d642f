"""What can be done to an inspection: cancel it, try it again."""

from __future__ import annotations

from collections.abc import Callable
from http import HTTPStatus
from typing import Any

from fastapi import APIRouter, Request, Response
from pydantic import BaseModel, ConfigDict, Field
from starlette.concurrency import run_in_threadpool

from api.auth import Submitter
from api.finding import find_inspection
from api.limits import require_space
from api.problems import FieldError, Refused, pointer, responses
from api.routes.inspections import represent
from api.schemas import Parameters, Resource
from api.services import Services
from api.state import state_of
from api.submit import require_priority, settings_of
from core.fingerprint import canonical_json
from core.settings import Settings
from core.states import InspectionState
from store.files import ArtifactStore
from store.inspections import delete_results_from
from store.leasing import input_files
from store.models import ACTIVE_INSPECTION, Inspection
from store.status import shown_state

router = APIRouter(prefix="/v1/inspections/{inspection_id}", tags=["inspections"])

AUTO = "auto"
_MANIFEST = "result.json"


class Retry(BaseModel):
    """How to try again."""

    model_config = ConfigDict(
        extra="forbid", json_schema_extra={"example": {"from_stage": "auto", "parameters": {"preset": "default"}}}
    )

    from_stage: str = Field(
        AUTO, max_length=64, description="`auto` computes what is missing or changed; a stage's name makes it anew too"
    )
    parameters: Parameters | None = Field(None, description="other parameters; null = the same")


@router.post(
    "/cancel",
    status_code=202,
    response_model=Resource,
    summary="Stop an inspection",
    responses=responses(401, 404, 409, 410, 503),
)
async def cancel(request: Request, caller: Submitter, inspection_id: str) -> Response:
    """Ask to stop; every process of it is gone within 10 s. Asking again changes nothing; 409 once it is over."""
    state = state_of(request)
    await run_in_threadpool(_cancel, state.services, inspection_id, caller.owner)
    state.watcher.invalidate(inspection_id)
    return await represent(state, inspection_id, caller, status=HTTPStatus.ACCEPTED)


def _cancel(services: Services, inspection_id: str, owner: str) -> None:
    find_inspection(services, inspection_id, owner)
    reached = services.plan.cancel(inspection_id)
    if reached not in (InspectionState.CANCELLING, InspectionState.CANCELLED):
        raise Refused(HTTPStatus.CONFLICT, "not_cancellable", f"the inspection is over: {reached}")
    services.wake(inspection_id)


@router.post(
    "/retry",
    status_code=202,
    response_model=Resource,
    summary="Try an inspection again",
    responses=responses(400, 401, 404, 409, 410, 422, 429, 503, 507),
)
async def retry(request: Request, caller: Submitter, inspection_id: str, body: Retry | None = None) -> Response:
    """Begin the next attempt: what is unchanged is taken over, parameters may change. 409 while it is active."""
    state = state_of(request)
    asked = body or Retry()
    await run_in_threadpool(begin_again, state.services, inspection_id, caller.owner, lambda known: asked)
    state.watcher.invalidate(inspection_id)
    return await represent(state, inspection_id, caller, status=HTTPStatus.ACCEPTED)


def begin_again(services: Services, inspection_id: str, owner: str, ask: Callable[[dict[str, Any]], Retry]) -> None:
    """Begin the next attempt of an inspection that is over; `ask` is given its parameters and says what to change."""
    row = find_inspection(services, inspection_id, owner)
    asked = ask(dict(row.parameters or {}))
    if shown_state(row) in ACTIVE_INSPECTION:
        raise Refused(HTTPStatus.CONFLICT, "active", "the inspection is not over; cancel it first")
    _require_stage(services, asked.from_stage)
    settings, changes = _settings(row, asked.parameters)
    require_priority(services, owner, changes.get("priority", 0))
    require_space(services)
    # The place is held first: a retry that is refused must not have cost results.
    with services.admission.place(owner) as place:
        if asked.from_stage != AUTO:
            _remove_results(
                services.results, delete_results_from(services.inspections, inspection_id, asked.from_stage)
            )
        services.inspections.reopen(
            inspection_id, input_files(row), settings, ended_only=True, admit=place.use, **changes
        )
    services.wake(inspection_id)


def _require_stage(services: Services, stage: str) -> None:
    if stage != AUTO and stage not in services.graph.stages:
        detail = f"unknown stage '{stage}'; known: {AUTO}, {', '.join(services.graph.stages)}"
        errors = [FieldError(pointer="/from_stage", detail=detail)]
        raise Refused(HTTPStatus.UNPROCESSABLE_ENTITY, "bad_stage", detail, where="from_stage", errors=errors)


def _settings(row: Inspection, parameters: Parameters | None) -> tuple[Settings, dict[str, Any]]:
    """Settings of the next attempt, and the columns that change with them."""
    if parameters is None:
        return Settings.model_validate(row.settings), {}
    try:
        canonical_json(parameters.options).encode()
    except ValueError:
        errors = [FieldError(pointer=pointer(("parameters", "options")), detail="numbers must be finite")]
        status = HTTPStatus.UNPROCESSABLE_ENTITY
        raise Refused(status, "bad_parameters", errors[0].detail, where="options", errors=errors) from None
    changes: dict[str, Any] = {"parameters": {"preset": parameters.preset, "options": parameters.options}}
    given: dict[str, Any] = {
        "label": parameters.label,
        "external_id": parameters.external_id,
        "priority": parameters.priority,
    }
    given["metadata"] = parameters.metadata
    changes.update({name: value for name, value in given.items() if value})
    return settings_of(parameters), changes


def _remove_results(results: ArtifactStore, folders: list[str]) -> None:
    """Remove forgotten results, each with its manifest first: what a crash leaves then is no result."""
    for folder in folders:
        results.remove(f"{folder}/{_MANIFEST}")
        for path in results.list(folder):
            results.remove(path)
