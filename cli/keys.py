"""`bladeatlas keys`: make, rotate, list and revoke API keys, in the database of this machine's server."""

from __future__ import annotations

import argparse
from dataclasses import asdict
from datetime import timedelta

from cli.terminal import say, say_json
from core.errors import BadInput
from store.account_data import plain
from store.account_models import DEFAULT_ACCOUNT, USUAL_SCOPES
from store.accounts import Accounts
from store.audit import audited
from store.db import Database
from store.environment import deployment_settings
from store.factory import open_database
from store.keys import Keys, KeyView, parse_scopes, utc_now

_MOST_DAYS = 36_500.0
_MOST_HOURS = 8760.0


def command(parsed: argparse.Namespace) -> int:
    """Do what was asked for; a new key is printed once and never again."""
    database = open_database(deployment_settings())
    try:
        if parsed.action == "list":
            _list(Keys(database).all(parsed.account), parsed.json)
        else:
            with audited(database, f"keys {parsed.action}", parsed.name):
                _change(parsed, database)
    finally:
        database.close()
    return 0


def _change(parsed: argparse.Namespace, database: Database) -> None:
    keys = Keys(database)
    if parsed.action == "create":
        account = parsed.account or only_account(database)
        scopes = USUAL_SCOPES if parsed.scopes is None else parse_scopes(parsed.scopes.split(","))
        days = None if parsed.days is None else timedelta(days=within(parsed.days, _MOST_DAYS, "--days"))
        _show(*keys.create(parsed.name, account, scopes, None if days is None else utc_now() + days), parsed.json)
    elif parsed.action == "rotate":
        keep = timedelta(hours=within(parsed.keep_hours, _MOST_HOURS, "--keep-hours"))
        _show(*keys.rotate(parsed.name, keep), parsed.json)
    else:
        keys.revoke(parsed.name)


def within(number: float, most: float, where: str) -> float:
    """The number; `BadInput` unless it is between 0 and `most`."""
    if not 0 <= number <= most:
        raise BadInput(f"{number:g} is not between 0 and {most:g}", where=where)
    return number


def only_account(database: Database) -> str:
    """The account `default` while there is no other: what is made for the wrong one would show it to strangers."""
    others = [one.id for one in Accounts(database).all() if one.id != DEFAULT_ACCOUNT and one.closed_at is None]
    if others:
        message = f"there are several accounts; say whose it is: {DEFAULT_ACCOUNT}, {', '.join(others)}"
        raise BadInput(message, where="--account")
    return DEFAULT_ACCOUNT


def _show(view: KeyView, key: str, as_json: bool) -> None:
    if as_json:
        say_json({**plain(asdict(view)), "key": key})
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
            say_json(plain(asdict(view)))
        else:
            say(f"{view.id}  {view.account_id}  {state}  {','.join(view.scopes)}  last used {used}  {view.name}")
