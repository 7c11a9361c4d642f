"""`bladeatlas accounts`: make, change and list accounts, in the database of this machine's server."""

from __future__ import annotations

import argparse
from dataclasses import asdict
from typing import Any

from cli.account_arguments import LIMITS, USUAL
from cli.terminal import say, say_json
from core.errors import BadInput
from store.accounts import Accounts, AccountView
from store.db import Database
from store.factory import open_database
from store.settings import DeploymentSettings, deployment_settings


def command(parsed: argparse.Namespace) -> int:
    """Do what was asked for."""
    settings = deployment_settings()
    database = open_database(settings)
    try:
        _ACTIONS[parsed.action](parsed, database, settings)
    finally:
        database.close()
    return 0


def _create(parsed: argparse.Namespace, database: Database, settings: DeploymentSettings) -> None:
    _show([Accounts(database).create(parsed.id, parsed.name or "", **_limits(parsed))], parsed.json)


def _set(parsed: argparse.Namespace, database: Database, settings: DeploymentSettings) -> None:
    _show([Accounts(database).change(parsed.id, parsed.name, **_limits(parsed))], parsed.json)


def _list(parsed: argparse.Namespace, database: Database, settings: DeploymentSettings) -> None:
    _show(Accounts(database).all(), parsed.json)


_ACTIONS = {"create": _create, "set": _set, "list": _list}


def _limits(parsed: argparse.Namespace) -> dict[str, float | None]:
    """The limits that were named; `USUAL` brings the deployment's own back."""
    found: dict[str, float | None] = {}
    for name, (kind, _) in LIMITS.items():
        text = getattr(parsed, name)
        if text is None:
            continue
        try:
            found[name] = None if text == USUAL else kind(text)
        except ValueError:
            option = f"--{name.replace('_', '-')}"
            raise BadInput(f"'{text}' is neither a number nor the word '{USUAL}'", where=option) from None
    return found


def _show(found: list[AccountView], as_json: bool) -> None:
    for view in found:
        if as_json:
            say_json(_record(view))
            continue
        limits = ((name, getattr(view, name)) for name in LIMITS)
        words = " ".join(f"{name}={value:g}" for name, value in limits if value is not None)
        say(f"{view.id}  {'closed' if view.closed_at else 'open'}  {words}  {view.name}")


def _record(view: AccountView) -> dict[str, Any]:
    return {name: value.isoformat() if hasattr(value, "isoformat") else value for name, value in asdict(view).items()}
