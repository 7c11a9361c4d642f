"""`bladeatlas keys`: make, list and revoke API keys, in the database of this machine's server."""

from __future__ import annotations

import argparse
from dataclasses import asdict
from typing import Any

from cli.terminal import say, say_json
from store.factory import open_database
from store.keys import Keys, KeyView
from store.settings import deployment_settings


def command(parsed: argparse.Namespace) -> int:
    """Do what was asked for; a new key is printed once and never again."""
    database = open_database(deployment_settings())
    try:
        keys = Keys(database)
        if parsed.action == "create":
            view, key = keys.create(parsed.name)
            if parsed.json:
                say_json({**_record(view), "key": key})
            else:
                say(key)
        elif parsed.action == "revoke":
            keys.revoke(parsed.name)
        else:
            _list(keys.all(), parsed.json)
    finally:
        database.close()
    return 0


def _list(found: list[KeyView], as_json: bool) -> None:
    for view in found:
        state = "revoked" if view.revoked_at else "valid"
        used = view.last_used_at.isoformat(timespec="seconds") if view.last_used_at else "never"
        if as_json:
            say_json(_record(view))
        else:
            say(f"{view.id}  {state}  last used {used}  {view.name}")


def _record(view: KeyView) -> dict[str, Any]:
    return {name: value.isoformat() if hasattr(value, "isoformat") else value for name, value in asdict(view).items()}
