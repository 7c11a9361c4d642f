"""Review records as OpenAPI describes them; `core.review` says what each action needs and checks it."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field

from api.parameters import OneOf
from api.schemas import EXAMPLE_ID
from core.review.words import Action, ReviewState, TargetKind

_TARGET: dict[str, Any] = {
    "kind": "defect",
    "id": 3,
    "label": "dent",
    "model": 0,
    "centroid": [0.12, -0.4, 2.31],
    "sigma": 0.004,
}
_NEW: dict[str, Any] = {
    "id": "5f0c9e6c1d7b4a6f8f0e3b2a1c4d5e6f",
    "target": _TARGET,
    "action": "reject",
    "value": None,
    "reason": "not damage",
}
_RECORD: dict[str, Any] = {**_NEW, "revision": 8, "time": "2026-05-04T09:30:02.118Z", "by": "anna"}
_Point = Annotated[list[float], Field(min_length=3, max_length=3)]
_Id = Annotated[str, Field(min_length=1, max_length=64, pattern=r"^[A-Za-z0-9:.+_-]+$")]


class ReviewTarget(BaseModel):
    """The finding that a record speaks of, named by number, label and place."""

    model_config = ConfigDict(extra="forbid", json_schema_extra={"example": _TARGET})

    kind: Annotated[str, OneOf(TargetKind)] = Field(description="who made the finding: the method, or a person")
    id: int | str = Field(description="number of the defect; of an added finding the id of the record that made it")
    label: str = Field(max_length=1000, description="the machine's label")
    model: int | None = Field(0, ge=0, lt=2**31)
    centroid: _Point | None = Field(None, description="in the world frame of the model")
    sigma: float | None = Field(None, ge=0, description="standard deviation of the place, units of the model")


class _Said(BaseModel):
    target: ReviewTarget
    action: Annotated[str, OneOf(Action)]
    value: str | dict[str, Any] | None = Field(
        None, description="what the action needs, such as a label; docs/how-to/inspect.md has the forms"
    )
    reason: str | None = Field(None, max_length=200, description="of a rejection one of the fixed reasons")


class NewReview(_Said):
    """A record to be appended."""

    model_config = ConfigDict(extra="forbid", json_schema_extra={"example": {**_NEW, "revision": 7}})

    id: _Id | None = Field(None, description="at random; the same record sent twice is kept once. Left out: a new one")
    revision: int = Field(ge=0, lt=2**31, description="of the last record that the writer has seen; 0 = of none")


class ReviewItem(_Said):
    """A record as it is kept."""

    model_config = ConfigDict(extra="allow", json_schema_extra={"example": _RECORD})

    id: str
    revision: int = Field(ge=1, description="its number, from 1 without gaps")
    time: str = Field(description="when it came, by the service's clock")
    by: str = Field(description="name of the key that it was written with; without a key the account")


class ReviewList(BaseModel):
    """Records behind a revision, in the form of a `review.json`."""

    model_config = ConfigDict(
        json_schema_extra={
            "example": {
                "schema_version": 2,
                "inspection": EXAMPLE_ID,
                "revision": 8,
                "records": [_RECORD],
                "severities": ["serviceable", "monitor", "reject"],
                "may_review": True,
                "you": "anna",
            }
        }
    )

    schema_version: int
    inspection: str
    revision: int = Field(description="of the last record; `since` of the next request")
    records: list[ReviewItem]
    severities: list[str] = Field(description="what a record of the action `severity` may say here")
    may_review: bool = Field(description="whether the caller may write records")
    you: str = Field(description="`by` of the records that the caller writes")


class Handover(BaseModel):
    """Records that were made elsewhere: a `review.json`."""

    model_config = ConfigDict(
        extra="forbid", json_schema_extra={"example": {"schema_version": 2, "records": [{**_RECORD, "revision": 1}]}}
    )

    schema_version: int
    records: list[dict[str, Any]] = Field(max_length=100_000)
    title: str | None = None
    fingerprint: str | None = None
    model: int | None = None
    inspection: str | None = None
    revision: int | None = None
    severities: list[str] | None = None
    may_review: bool | None = None
    you: str | None = None


class HandedOver(BaseModel):
    """What came of records that were handed over."""

    model_config = ConfigDict(json_schema_extra={"example": {"added": 4, "known": 1, "revision": 12}})

    added: int
    known: int = Field(description="were there already")
    revision: int = Field(description="of the last record now")


class ReviewedItem(BaseModel):
    """A finding with what people say of it."""

    model_config = ConfigDict(extra="allow")

    name: str = Field(description="`D3` for the method's, `H1` for people's, `U1` for what is not attached")
    target: ReviewTarget
    review: dict[str, Any]
    made: ReviewItem | None = Field(description="the record that made it; null for the method's")


class ReviewedAnswer(BaseModel):
    """The findings after review."""

    model_config = ConfigDict(
        json_schema_extra={
            "example": {
                "revision": 8,
                "findings": [
                    {
                        "name": "D3",
                        "target": _TARGET,
                        "review": {"state": ReviewState.REJECTED, "reason": "not damage"},
                        "made": None,
                    }
                ],
                "unattached": [],
            }
        }
    )

    revision: int
    findings: list[ReviewedItem]
    unattached: list[ReviewedItem] = Field(description="said of findings that the result does not have (any more)")
