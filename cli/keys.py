"""`bladeatlas keys`: make, rotate, list and revoke API keys, in the database of this machine's server."""

from __future__ import annotations

import argparse
from dataclasses import asdict
from datetime import timedelta
from typing import Any

from cli.terminal import say, say_json
from core.errors import BadInput
from store.account_models import DEFAULT_ACCOUNT, USUAL_SCOPES
from store.accounts import Accounts
from store.db import Database
from store.factory import open_database
from store.keys import Keys, KeyView, parse_scopes, utc_now
from store.settings import deployment_settings


def command(parsed: argparse.Namespace) -> int:
    """Do what was asked for; a new key is printed once and never again."""
    database = open_database(deployment_settings())
    try:
        keys = Keys(database)
        if parsed.action == "create":
            account = parsed.account or _only_account(database)
            expires_at = None if parsed.days is None else utc_now() + timedelta(days=parsed.days)
            scopes = USUAL_SCOPES if parsed.scopes is None else parse_scopes(parsed.scopes.split(","))
            made = keys.create(parsed.name, account, scopes, expires_at)
            _show(*made, parsed.json)
        elif parsed.action == "rotate":
            _show(*keys.rotate(parsed.name, timedelta(hours=parsed.keep_hours)), parsed.json)
        elif parsed.action == "revoke":
            keys.revoke(parsed.name)
        else:
            _list(keys.all(parsed.account), parsed.json)
    finally:
        database.close()
    return 0


def _only_account(database: Database) -> str:
    """The account `default` while there is no other: a key of the wrong account would show it to strangers."""
    others = [one.id for one in Accounts(database).all() if one.id != DEFAULT_ACCOUNT and one.closed_at is None]
    if others:
        message = f"there are several accounts; say whose key it is: {DEFAULT_ACCOUNT}, {', '.join(others)}"
        raise BadInput(message, where="--account")
    return DEFAULT_ACCOUNT


def _show(view: KeyView, key: str, as_json: bool) -> None:
    if as_json:
        say_json({**_record(view), "key": key})
        return
    say(key)
    say(f"key {view.id} of the account '{view.account_id}' ({', '.join(view.scopes)})", error=True)


def _list(found: list[KeyView], as_json: bool) -> None:
    now = utc_now()
    for view in found:
        ended = view.ended(now)
        state = ended.split()[-1] if ended else "valid"
        used = view.last_used_at.isoformat(timespec="seconds") if view.last_used_at else "never"
        if as_json:
            say_json(_record(view))
        else:
            say(f"{view.id}  {view.account_id}  {state}  {','.join(view.scopes)}  last used {used}  {view.name}")


def _record(view: KeyView) -> dict[str, Any]:
    return {name: value.isoformat() if hasattr(value, "isoformat") else value for name, value in asdict(view).items()}
