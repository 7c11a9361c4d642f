"""What a person knows of the row of blades: it makes a new attempt, in which only what depends on it is computed."""

from __future__ import annotations

from http import HTTPStatus
from typing import Any, Literal

from fastapi import APIRouter, Request, Response
from pydantic import BaseModel, ConfigDict, Field
from starlette.concurrency import run_in_threadpool

from api.auth import Submitter
from api.problems import Refused, responses
from api.routes.actions import Retry, begin_again
from api.routes.inspections import represent
from api.schemas import Parameters, Resource
from api.state import state_of

router = APIRouter(prefix="/v1/inspections/{inspection_id}", tags=["inspections"])


class ScaleTold(BaseModel):
    """A known length between two pixels of a frame: the options `scale.*`."""

    model_config = ConfigDict(extra="forbid")

    points: tuple[float, float, float, float] = Field(description="x and y of two pixels of the source frame")
    length_mm: float = Field(description="length between them, mm")
    length_sigma_mm: float | None = Field(None, description="its standard deviation, mm; null = 1 %")
    time_s: float = Field(0.0, description="time of the frame, s")
    video: int = Field(0, description="number of its video")


_TOLD = ("row.", "limits.")
"""Beginnings of options that null takes back."""


class RowTold(BaseModel):
    """The options `row.*`, `scale.*` and `limits.table` that change; those not named stay, null takes one back."""

    model_config = ConfigDict(extra="forbid", json_schema_extra={"example": {"count": 64, "edge_a": "leading"}})

    count: int | None = Field(None, description="blades in the whole row")
    zero_blade: int | None = Field(None, description="which blade, in order of first appearance, is number 1")
    direction: Literal["as_seen", "reversed"] | None = Field(None, description="in which order the numbers rise")
    edge_a: Literal["leading", "trailing"] | None = Field(None, description="what edge a of row.json is")
    radius_mm: float | None = Field(None, description="distance of `radius_at` from the axis of the engine, mm")
    radius_sigma_mm: float | None = Field(None, description="its standard deviation, mm")
    radius_at: Literal["root", "tip"] | None = Field(None, description="the end of the blades that it is of")
    same_blade: str | None = Field(None, description="a blade of a further model that is one of the first: `1-B4=2`")
    scale: ScaleTold | None = Field(None, description="a known length in a frame")
    limits: str | None = Field(None, description="limits of the shop, a table in CSV or JSON; null takes it back")

    def options(self, known: dict[str, Any]) -> dict[str, Any]:
        """The options of a run, changed."""
        options = dict(known)
        given = self.model_dump(mode="json", exclude_unset=True)
        if "scale" in given:
            scale = given.pop("scale") or {}
            options = {name: value for name, value in options.items() if not name.startswith("scale.")}
            options |= {f"scale.{name}": value for name, value in scale.items()}
        if "limits" in given:
            options["limits.table"] = given.pop("limits")
        options |= {f"row.{name}": value for name, value in given.items()}
        return {name: value for name, value in options.items() if value is not None or not name.startswith(_TOLD)}


@router.patch(
    "/row",
    status_code=202,
    response_model=Resource,
    summary="Tell what is known of the row of blades",
    responses=responses(400, 401, 404, 409, 410, 422, 429, 503, 507),
)
async def tell(request: Request, caller: Submitter, inspection_id: str, body: RowTold) -> Response:
    """Begin the next attempt with it: blades are numbered anew, model and surface are taken over, ids of defects stay.

    409 while it is active.
    """
    if not body.model_fields_set:
        raise Refused(HTTPStatus.UNPROCESSABLE_ENTITY, "bad_parameters", "nothing is told of the row", where="body")
    state = state_of(request)

    def changed(known: dict[str, Any]) -> Retry:
        preset, options = str(known.get("preset", "default")), dict(known.get("options", {}))
        return Retry(from_stage="auto", parameters=Parameters(preset=preset, options=body.options(options)))

    await run_in_threadpool(begin_again, state.services, inspection_id, caller.owner, changed)
    state.watcher.invalidate(inspection_id)
    return await represent(state, inspection_id, caller, status=HTTPStatus.ACCEPTED)
