"""`bladeatlas webhooks`: make, test, rotate, list and delete webhooks, in the database of this machine's server."""

from __future__ import annotations

import argparse
from collections.abc import Iterable
from dataclasses import asdict
from datetime import timedelta

from cli.keys import only_account, within
from cli.terminal import say, say_json
from core.errors import BadInput
from store.account_data import plain
from store.audit import audited
from store.db import Database
from store.deliveries import Deliveries, DeliveryView
from store.environment import deployment_settings
from store.factory import open_database
from store.outbound import Outbound
from store.settings import DeploymentSettings
from store.webhooks import Webhooks, WebhookView

_MOST_HOURS = 720.0
_MOST_LISTED = 1000


def command(parsed: argparse.Namespace) -> int:
    """Do what was asked for; a new secret is printed once and never again."""
    settings = deployment_settings()
    database = open_database(settings)
    try:
        if parsed.action == "list":
            _list(Webhooks(database).all(parsed.account), parsed.json)
        elif parsed.action == "deliveries":
            _show_deliveries(_page(parsed, database), parsed.json)
        else:
            with audited(database, f"webhooks {parsed.action}", parsed.target):
                _change(parsed, database, settings)
    finally:
        database.close()
    return 0


def _change(parsed: argparse.Namespace, database: Database, settings: DeploymentSettings) -> None:
    webhooks = Webhooks(database)
    if parsed.action == "create":
        Outbound(settings.allowed_networks()).addresses(parsed.target)
        account = parsed.account or only_account(database)
        types = parsed.types.split(",") if parsed.types else ()
        most = settings.max_webhooks_per_owner
        _show(*webhooks.create(account, parsed.target, parsed.description, types, most), parsed.json)
    elif parsed.action == "rotate":
        keep = timedelta(hours=within(parsed.keep_hours, _MOST_HOURS, "--keep-hours"))
        _show(*webhooks.rotate(parsed.target, keep), parsed.json)
    elif parsed.action == "test":
        _show_deliveries([Deliveries(webhooks).test(parsed.target)], parsed.json)
    elif parsed.action == "redeliver":
        _show_deliveries([Deliveries(webhooks).again(parsed.target, parsed.delivery)], parsed.json)
    else:
        webhooks.delete(parsed.target)


def _page(parsed: argparse.Namespace, database: Database) -> Iterable[DeliveryView]:
    if not 1 <= parsed.limit <= _MOST_LISTED:
        raise BadInput(f"{parsed.limit} is not between 1 and {_MOST_LISTED}", where="--limit")
    webhooks = Webhooks(database)
    owner = webhooks.get(parsed.target).owner
    return Deliveries(webhooks).page(parsed.target, owner, None, parsed.limit).deliveries


def _show(view: WebhookView, secret: str, as_json: bool) -> None:
    if as_json:
        say_json({**plain(asdict(view)), "secret": secret})
        return
    say(secret)
    say(f"webhook {view.id} of the account '{view.owner}' to {view.url}", error=True)


def _list(found: Iterable[WebhookView], as_json: bool) -> None:
    for view in found:
        if as_json:
            say_json(plain(asdict(view)))
            continue
        state = "gone" if view.disabled_at else "unanswered" if view.failures else "good"
        say(f"{view.id}  {view.owner}  {state}  {','.join(view.types) or 'all'}  {view.url}  {view.description}")


def _show_deliveries(found: Iterable[DeliveryView], as_json: bool) -> None:
    for view in found:
        if as_json:
            say_json(plain(asdict(view)))
            continue
        about = f"{view.inspection_id} {view.number}" if view.inspection_id else "-"
        last = view.status or "-"
        say(f"{view.id}  {view.type}  {about}  {view.state}  attempts {view.attempts}  {last}  {view.error}")
