"""Signed links: whoever has one may read one thing of an inspection until its time is over, without a key.

A link is signed with a secret of the account (HMAC-SHA-256, RFC 2104), which never leaves the database; changing the
secret ends every link that was given out. The signature is over the account, what is read, and the time.
"""

from __future__ import annotations

import hashlib
import hmac
import json
import secrets
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta

from sqlalchemy import select, update

from store.account_models import Account
from store.accounts import open_account
from store.db import Database
from store.leasing import changed
from store.models import Inspection

LONGEST = timedelta(days=30)
"""No link is good for longer."""


@dataclass(frozen=True)
class Signature:
    """What makes an address a link."""

    expires: int
    """Seconds since 1970."""
    signature: str
    """Hexadecimal."""


@dataclass(frozen=True)
class Links:
    """Signed links of all accounts of one database."""

    db: Database

    def sign(self, account_id: str, inspection_id: str, path: str, lifetime: timedelta) -> Signature:
        """A link's signature.

        Args:
            account_id: whose inspection it is.
            inspection_id: of it.
            path: of what is read, below the inspection, e.g. ``artifacts/mapping/mesh.ply``.
            lifetime: how long it is good, at most `LONGEST`.

        Raises:
            BadInput: there is no such account, or it was closed.
        """
        with self.db.write() as session:
            account = open_account(session, account_id)
            if account.link_secret is None:  # two requests at once must not sign with two secrets
                mine = (Account.id == account_id, Account.link_secret.is_(None))
                changed(session, update(Account).where(*mine).values(link_secret=secrets.token_hex(32)))
                session.refresh(account)
            secret, now = account.link_secret or "", self.db.now(session)
        expires = int((now + min(lifetime, LONGEST)).timestamp())
        return Signature(expires, _signature(secret, account_id, inspection_id, path, expires))

    def owner(self, inspection_id: str, path: str, given: Signature) -> str | None:
        """The account in whose name a link reads; None when it is not good, or not any more."""
        query = select(Account.id, Account.link_secret).join(Inspection, Inspection.owner == Account.id)
        with self.db.read() as session:
            now = self.db.now(session)
            row = session.execute(
                query.where(Inspection.id == inspection_id, Account.link_secret.is_not(None))
            ).one_or_none()
        if row is None or datetime.fromtimestamp(given.expires, UTC) <= now:
            return None
        expected = _signature(row.link_secret, row.id, inspection_id, path, given.expires)
        return str(row.id) if hmac.compare_digest(expected, given.signature) else None

    def revoke(self, account_id: str) -> None:
        """End every link of an account; `BadInput` when there is no such account, or it was closed."""
        with self.db.write() as session:
            open_account(session, account_id).link_secret = None


def _signature(secret: str, *about: str | int) -> str:
    # As JSON, so that no two different lists are signed as one text.
    return hmac.new(bytes.fromhex(secret), json.dumps(about).encode(), hashlib.sha256).hexdigest()
