"""Finding what a path names: 404 for what is not there or belongs to another account, 410 for what was deleted."""

from __future__ import annotations

from http import HTTPStatus

from api.problems import Refused, not_found
from api.services import Services
from store.models import Inspection

_ID_LENGTH = 32


def is_id(text: str) -> bool:
    """True for the form of our ids; what else stands in a path never comes near the database or a folder."""
    return len(text) == _ID_LENGTH and all(c in "0123456789abcdef" for c in text)


def find_inspection(services: Services, inspection_id: str, owner: str) -> Inspection:
    """The inspection's row, detached."""
    row = None
    if is_id(inspection_id):
        with services.db.read() as session:
            row = session.get(Inspection, inspection_id)
    if row is None or row.owner != owner:
        raise not_found("inspection")
    if row.deleted_at is not None:
        raise gone()
    return row


def gone() -> Refused:
    """410: it was deleted."""
    return Refused(HTTPStatus.GONE, "gone", "this inspection was deleted")
