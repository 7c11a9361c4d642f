"""Options, presets and limits: what an inspection can be asked for."""

from __future__ import annotations

import json
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Request, Response
from pydantic import BaseModel, ConfigDict, Field, TypeAdapter

from api.auth import Reader, requires
from api.problems import responses
from api.schemas import Parameters
from api.sending import MAX_INLINE_BYTES, MAX_PARAMETERS_BYTES
from api.state import state_of
from core.annotations.form import json_schema
from core.settings import PRESET_NAMES, Settings, make_settings, option_names
from core.settings.describe import describe_options
from store.account_models import Scope
from store.accounts import Accounts
from store.settings import DeploymentSettings

router = APIRouter(
    prefix="/v1", tags=["options"], dependencies=[Depends(requires(Scope.READ))], responses=responses(401)
)

_SCHEMA_TYPE = "application/schema+json"

_OPTION_EXAMPLE: dict[str, Any] = {
    "name": "matching.window",
    "meaning": "each frame is paired with this many following frames",
    "unit": "frames",
    "default": 5,
    "range": "integer >= 1",
    "source": "thesis",
    "presets": {},
}


class Option(BaseModel):
    """One option in words."""

    model_config = ConfigDict(json_schema_extra={"example": _OPTION_EXAMPLE})

    name: str = Field(description="dotted name, as in `--set name=value`")
    meaning: str
    unit: str = Field(description="unit of the value, empty for a bare number")
    default: Any = Field(description="value in the preset `default`")
    range: str = Field(description="allowed values in words")
    source: str = Field(description="where the default comes from")
    presets: dict[str, Any] = Field(description="value in each preset that differs")


class Options(BaseModel):
    """All options, in the order of the method."""

    model_config = ConfigDict(json_schema_extra={"example": {"options": [_OPTION_EXAMPLE]}})

    options: list[Option]
    json_schema: dict[str, Any] = Field({}, description="JSON Schema of the document `parameters`")


class Presets(BaseModel):
    """Every preset's full settings and their JSON Schema."""

    model_config = ConfigDict(
        json_schema_extra={"example": {"presets": {"draft": {"matching": {"window": 5}}}, "json_schema": {}}}
    )

    presets: dict[str, dict[str, Any]] = Field(description="preset and all its values")
    json_schema: dict[str, Any] = Field(description="JSON Schema of these settings")


class Preset(BaseModel):
    """One preset's full settings."""

    model_config = ConfigDict(json_schema_extra={"example": {"name": "draft", "settings": {"matching": {"window": 5}}}})

    name: str
    settings: dict[str, Any]


@router.get("/options", summary="Every option: meaning, unit, default, range, source")
def options() -> Options:
    """List all options; a run refuses any other name."""
    return Options(options=[Option(**option.to_dict()) for option in describe_options()], json_schema=_schema())


def _schema() -> dict[str, Any]:
    """JSON Schema of the parameters with every option under its dotted name."""
    schema = Parameters.model_json_schema()
    schema["properties"]["preset"]["enum"] = list(PRESET_NAMES)
    options = {name: _option_schema(info) for name, info in option_names().items()}
    schema["properties"]["options"] = {"type": "object", "additionalProperties": False, "properties": options}
    return schema


def _option_schema(info: Any) -> dict[str, Any]:
    """JSON Schema of one option: type, range, default, meaning, unit, source."""
    adapter: TypeAdapter[Any] = TypeAdapter(Annotated[info.annotation, info])
    return adapter.json_schema()


@router.get(
    "/schemas/annotations.json",
    summary="JSON Schema of our own form of annotations",
    response_class=Response,
    responses={200: {"content": {_SCHEMA_TYPE: {"schema": {"type": "object"}}}}},
)
def annotations_schema() -> Response:
    """What a file of annotations may hold. Files of other tools have the forms that these tools give them."""
    return Response(json.dumps(json_schema()), media_type=_SCHEMA_TYPE)


@router.get("/presets", summary="Presets and the JSON Schema of settings")
def presets() -> Presets:
    """Every preset with all its values."""
    values = {name: make_settings(name).model_dump(mode="json") for name in PRESET_NAMES}
    return Presets(presets=values, json_schema=Settings.model_json_schema())


@router.get("/presets/{name}", summary="One preset", responses=responses(422))
def preset(name: str) -> Preset:
    """All values of one preset; 422 for an unknown name."""
    return Preset(name=name, settings=make_settings(name).model_dump(mode="json"))


class Limits(BaseModel):
    """What this server takes."""

    model_config = ConfigDict(
        json_schema_extra={
            "example": {
                "max_upload_bytes": 68719476736,
                "max_annotations_bytes": 134217728,
                "max_parameters_bytes": 1048576,
                "max_json_bytes": 8388608,
                "max_active": 100,
                "max_active_per_owner": 50,
                "max_open_uploads": 1000,
                "max_open_uploads_per_owner": 100,
                "max_promised_bytes": 0,
                "max_promised_bytes_per_owner": 274877906944,
                "max_kept_bytes": 0,
                "max_kept_bytes_per_owner": 0,
                "max_requests_per_minute": 0,
                "max_requests_per_minute_per_owner": 0,
                "max_event_streams": 500,
                "max_event_streams_per_owner": 20,
                "event_days": 30.0,
                "max_webhooks_per_owner": 20,
                "max_fetches": 16,
                "max_fetches_per_owner": 4,
                "fetch_seconds": 3600.0,
                "max_frame_pixels": 40000000,
                "max_video_frames": 500000,
                "max_video_seconds": 21600.0,
                "probe_seconds": 8.0,
                "probe_wait_seconds": 60.0,
                "max_probes_waiting": 200,
                "max_probes_waiting_per_owner": 50,
                "task_seconds": 14400.0,
                "task_cpu_seconds": 0.0,
                "task_memory_bytes": 0,
                "task_address_bytes": 68719476736,
                "task_file_bytes": 17179869184,
                "upload_hours": 72.0,
                "retention_days": 30.0,
            }
        }
    )

    max_upload_bytes: int = Field(description="largest upload, and largest video of a form")
    max_annotations_bytes: int = Field(description="largest annotation file")
    max_parameters_bytes: int = Field(description="largest `parameters` of a form")
    max_json_bytes: int = Field(description="largest JSON body")
    max_active: int = Field(description="inspections queued or running at once; more get 429")
    max_active_per_owner: int = Field(description="the same of this account, as all that end in `_per_owner`")
    max_open_uploads: int = Field(description="unfinished uploads, and forms that come in, at once; more get 429")
    max_open_uploads_per_owner: int = Field(description="the same of one owner")
    max_promised_bytes: int = Field(description="bytes that open uploads may still send; more get 429; 0 = no limit")
    max_promised_bytes_per_owner: int = Field(description="the same of this account")
    max_kept_bytes: int = Field(description="bytes of uploads, inputs and published files; more get 429; 0 = no limit")
    max_kept_bytes_per_owner: int = Field(description="the same of this account")
    max_requests_per_minute: int = Field(description="requests in a minute of the clock; more get 429; 0 = no limit")
    max_requests_per_minute_per_owner: int = Field(description="the same of this account")
    max_event_streams: int = Field(description="streams of events that a server keeps open; more get 429")
    max_event_streams_per_owner: int = Field(description="the same of one owner")
    event_days: float = Field(description="events are kept so long")
    max_webhooks_per_owner: int = Field(description="webhooks of one account; more get 429")
    max_fetches: int = Field(description="requests of one server that fetch inputs by URL at once; more get 429")
    max_fetches_per_owner: int = Field(description="the same of one owner")
    fetch_seconds: float = Field(description="a file by URL that takes longer gets 422")
    max_frame_pixels: int = Field(description="largest picture of a video in pixels; larger ones get 422")
    max_video_frames: int = Field(description="frames that a video's header may state; more get 422")
    max_video_seconds: float = Field(description="length that a video's header may state; longer ones get 422")
    probe_seconds: float = Field(description="processor time to look into a video; beyond it is 422")
    probe_wait_seconds: float = Field(description="who waits longer for that look gets 503")
    max_probes_waiting: int = Field(description="requests that wait for that look at once; more get 503")
    max_probes_waiting_per_owner: int = Field(description="the same of one owner; more get 429")
    task_seconds: float = Field(description="a task that runs longer ends its stage with `timeout`")
    task_cpu_seconds: float = Field(description="the same of processor time; 0 = `task_seconds` on each thread")
    task_memory_bytes: int = Field(description="a task that uses more memory ends its stage with `oom`; 0 = no limit")
    task_address_bytes: int = Field(description="the same of its address space, but on a GPU; 0 = no limit")
    task_file_bytes: int = Field(description="a task that writes a larger file fails, `file_too_large`; 0 = no limit")
    upload_hours: float = Field(description="an upload that nobody used is removed after this")
    retention_days: float = Field(description="an inspection is removed so long after it ended; 0 = never")


@router.get("/limits", summary="What this server takes")
def limits(request: Request, caller: Reader) -> Limits:
    """Sizes in bytes, times in hours and days. Where the account has a limit of its own, that is told."""
    services = state_of(request).services
    settings, accounts = services.settings, Accounts(services.db)
    values = {
        **{name: getattr(settings, name) for name in Limits.model_fields if name in DeploymentSettings.model_fields},
        **accounts.limits(caller.owner, settings),
        "retention_days": accounts.retention_days(caller.owner, settings),
        "max_parameters_bytes": MAX_PARAMETERS_BYTES,
        "max_json_bytes": MAX_INLINE_BYTES,
    }
    return Limits.model_validate(values)
