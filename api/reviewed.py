"""Tables with what people say beside what the machine says: `?reviewed=1`. The machine's columns stay as they are."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Any

from fastapi import Query

from api.negotiation import TableForm
from api.paging import Source
from core.review.state import Reviewed, ReviewedFinding
from core.review.tables import REVIEW_COLUMNS, cells_of, review_values
from core.review.words import TargetKind
from store.reviews import Reviews
from store.tables import DEFECTS, Page, Position

WithReview = Annotated[bool, Query(description="with `finding` and `review`: what people say beside the machine")]
"""Parameter of a route of a table of findings, or of what belongs to one."""


@dataclass(frozen=True)
class ReviewedSource(Source):
    """The same rows, each with the review of its finding; findings that people made follow the last page's."""

    def page(self, limit: int, after: Position | None) -> Page:
        """Rows of the machine's table with two more members, and behind the last those that people made."""
        page = super().page(limit, after)
        reviewed = Reviews(self.db).reviewed(self.inspection_id)
        said = {one.target.id: one for one in reviewed.findings if one.target.kind == TargetKind.DEFECT}
        number = "id" if self.table is DEFECTS else "defect_id"
        rows = [_with(row, said.get(row[number]) if row[number] is not None else None) for row in page.rows]
        if self.table is DEFECTS and page.next is None:
            rows += [_made(one) for one in self._chosen(reviewed)]
        return replace(page, rows=rows)

    def tag(self) -> Any:
        """The last revision: with it the rows change."""
        return Reviews(self.db).last(self.inspection_id)

    def _chosen(self, reviewed: Reviewed) -> list[ReviewedFinding]:
        """Findings that people made, as far as the filters let them through by what people say of them."""
        if self.chosen.min_confidence is not None:
            return []
        wanted = {name: value for name, value in self.chosen.equal.items() if value is not None}
        found = [one for one in reviewed.findings if one.made is not None]
        return [one for one in found if wanted.items() <= {**review_values(one)}.items()] if wanted else found


def reviewed_form(
    columns: Sequence[str], flat: Callable[[Mapping[str, Any]], Mapping[str, Any]], as_csv: bool
) -> TableForm:
    """The form of such a table: in CSV the columns of the review follow the machine's."""

    def both(row: Mapping[str, Any]) -> Mapping[str, Any]:
        return {**flat(row), **cells_of(row["finding"], row["review"])}

    return TableForm((*columns, *REVIEW_COLUMNS), as_csv=as_csv, flat=both)


def _with(row: Mapping[str, Any], one: ReviewedFinding | None) -> dict[str, Any]:
    return {**row, "finding": None if one is None else one.name, "review": None if one is None else review_values(one)}


def _made(one: ReviewedFinding) -> dict[str, Any]:
    """A finding that people made: the machine says nothing of it."""
    machine = {"id": None, "label": None, "model": one.target.model, "centroid": None}
    return {**machine, **_with({}, one), "made": None if one.made is None else one.made.to_dict()}
