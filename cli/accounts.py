"""`bladeatlas accounts`: make, change, export and delete accounts, in the database of this machine's server."""

from __future__ import annotations

import argparse
import json
import shutil
from collections.abc import Callable, Mapping
from dataclasses import asdict

from cli.account_arguments import LIMITS, USUAL
from cli.terminal import say, say_json
from core.errors import BadInput
from store.account_data import AccountData, plain
from store.accounts import Accounts, AccountView
from store.audit import AuditFilter, AuditLog, audited
from store.db import Database
from store.environment import deployment_settings
from store.factory import open_artifacts, open_database
from store.graph import load_graph
from store.plan import Plan
from store.settings import DeploymentSettings

_PAGE = 500


def command(parsed: argparse.Namespace) -> int:
    """Do what was asked for."""
    settings = deployment_settings()
    database = open_database(settings)
    try:
        if parsed.action == "list":
            _show(Accounts(database).all(), parsed.json)
        elif parsed.action == "audit":
            _audit(parsed, database)
        else:
            with audited(database, f"accounts {parsed.action}", parsed.id):
                _CHANGES[parsed.action](parsed, database, settings)
    finally:
        database.close()
    return 0


def _create(parsed: argparse.Namespace, database: Database, settings: DeploymentSettings) -> None:
    _show([Accounts(database).create(parsed.id, parsed.name or "", **_limits(parsed))], parsed.json)


def _set(parsed: argparse.Namespace, database: Database, settings: DeploymentSettings) -> None:
    _show([Accounts(database).change(parsed.id, parsed.name, **_limits(parsed))], parsed.json)


def _export(parsed: argparse.Namespace, database: Database, settings: DeploymentSettings) -> None:
    """Write ``account.json`` and a folder for every inspection."""
    data, out = AccountData(database, parsed.id), parsed.out
    record = data.record()
    if out.exists():
        raise BadInput(f"'{out}' exists already", where="--out")
    out.mkdir(parents=True)
    (out / "account.json").write_text(json.dumps(record, indent=2, ensure_ascii=False), encoding="utf-8")
    store, count = open_artifacts(settings), 0
    for file in data.files():
        target = out / file.inspection_id / file.path
        target.parent.mkdir(parents=True, exist_ok=True)
        with store.open(file.key) as source, target.open("wb") as copy:
            shutil.copyfileobj(source, copy)
        count += 1
    say(f"{len(record['inspections'])} inspections with {count} files in {out}")


def _delete(parsed: argparse.Namespace, database: Database, settings: DeploymentSettings) -> None:
    if not parsed.yes:
        raise BadInput(f"this deletes all that '{parsed.id}' has, for ever; say --yes", where="--yes")
    plan = Plan(database, load_graph(settings.graph), settings.lease_s, settings.max_attempts)
    count = len(AccountData(database, parsed.id).delete(plan))
    say(f"{count} inspections are deleted; their files go within minutes while a server or a worker runs")


_CHANGES: Mapping[str, Callable[[argparse.Namespace, Database, DeploymentSettings], None]] = {
    "create": _create,
    "set": _set,
    "export": _export,
    "delete": _delete,
}


def _audit(parsed: argparse.Namespace, database: Database) -> None:
    """Print entries, newest first."""
    log, cursor, left = AuditLog(database), None, parsed.limit
    while left > 0:
        page = log.page(AuditFilter(parsed.account), min(left, _PAGE), cursor)
        for entry in page.entries:
            if parsed.json:
                say_json(plain(asdict(entry)))
                continue
            who = f"{entry.account_id or '-'}/{entry.key_id or '-'}"
            outcome = f"{entry.status} {entry.code}".rstrip() + (f" x{entry.times}" if entry.times > 1 else "")
            say(f"{entry.at.isoformat(timespec='seconds')}  {who}  {entry.action}  {entry.target}  {outcome}")
        left, cursor = left - len(page.entries), page.cursor
        if cursor is None:
            return


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
            say_json(plain(asdict(view)))
            continue
        limits = ((name, getattr(view, name)) for name in LIMITS)
        words = " ".join(f"{name}={value:g}" for name, value in limits if value is not None)
        say(f"{view.id}  {'closed' if view.closed_at else 'open'}  {words}  {view.name}")
