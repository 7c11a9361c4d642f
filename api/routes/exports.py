"""All that an account has, as one archive."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import suppress
from datetime import UTC, datetime

from fastapi import APIRouter, Request
from fastapi.responses import StreamingResponse
from zipstream import ZipStream

from api.auth import AnyCaller
from api.negotiation import Span
from api.problems import responses
from api.routes.accounts import require_of_account
from api.routes.artifacts import stream_bytes
from api.state import state_of
from store.account_data import AccountData, AccountFile
from store.account_models import Scope
from store.files import ArtifactStore

router = APIRouter(prefix="/v1/accounts", tags=["accounts"])


@router.get(
    "/{account_id}/export.zip",
    summary="Export all that an account has",
    response_class=StreamingResponse,
    responses={
        200: {
            "description": "ZIP, not compressed, made while it is sent",
            "content": {"application/zip": {"schema": {"type": "string", "format": "binary"}}},
        },
        **responses(401, 404, 503),
    },
)
def export(request: Request, caller: AnyCaller, account_id: str) -> StreamingResponse:
    """`account.json` with all that is known of the account, and a folder with input and results of each inspection.

    Keys are in it without what opens anything. The caller's own account with the scope `manage`, any with `admin`.
    """
    require_of_account(caller, account_id, Scope.MANAGE)
    services = state_of(request).services
    data = AccountData(services.db, account_id)
    archived = ZipStream()
    archived.add(json.dumps(data.record(), indent=2, ensure_ascii=False).encode("utf-8", "replace"), "account.json")
    # Told before the first byte is sent: a database that is away is a 503 and no torso.
    files = list(data.files())
    name = f"{account_id}-{datetime.now(UTC):%Y%m%d}.zip"
    headers = {"Content-Disposition": f'attachment; filename="{name}"', "Cache-Control": "no-store"}
    return StreamingResponse(_sent(archived, services.artifacts, files), headers=headers, media_type="application/zip")


def _sent(archived: ZipStream, store: ArtifactStore, files: list[AccountFile]) -> Iterator[bytes]:
    """The archive, one file after the other; one that retention removes meanwhile is left out."""
    yield from archived.all_files()
    for file in files:
        with suppress(FileNotFoundError):
            span = Span(0, store.size(file.key))
            archived.add(stream_bytes(store, file.key, span), f"{file.inspection_id}/{file.path}")
            yield from archived.all_files()
    yield from archived.finalize()
