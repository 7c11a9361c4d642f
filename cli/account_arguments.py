"""What the commands about accounts, keys and webhooks accept; they work in the database of this machine's server."""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from pathlib import Path

Commands = argparse._SubParsersAction  # argparse has no public name for it
LIMITS: Mapping[str, tuple[type, str]] = {
    "retention_days": (float, "an inspection is removed so long after its publication; 0 = never"),
    "max_priority": (int, "highest priority of its inspections, 0 to 9"),
    "max_active": (int, "inspections queued or running at once"),
    "max_open_uploads": (int, "unfinished uploads, and forms while they come in, at once"),
    "max_promised_bytes": (int, "bytes that its open uploads and forms may still send; 0 = no limit"),
    "max_kept_bytes": (int, "bytes of its uploads, inputs and published files; 0 = no limit"),
    "max_requests_per_minute": (int, "0 = no limit"),
}
"""What can be set of an account, with its type and meaning; without a value the deployment's own holds."""
USUAL = "usual"
"""Stands for the deployment's own limit."""


def add_account_commands(commands: Commands[argparse.ArgumentParser]) -> None:
    """Register accounts, keys and webhooks."""
    _accounts(
        _add(commands, "accounts", "make, change, export and delete accounts in the database of this machine's server")
    )
    _keys(_add(commands, "keys", "make, rotate, list and revoke API keys in the database of this machine's server"))
    _webhooks(
        _add(
            commands,
            "webhooks",
            "make, test, rotate, list and delete webhooks in the database of this machine's server",
        )
    )


def _accounts(actions: Commands[argparse.ArgumentParser]) -> None:
    create = actions.add_parser("create", help="make an account; what it has belongs to all of its keys")
    change = actions.add_parser("set", help="set the name and limits of an account")
    for action in (create, change):
        action.add_argument("id", metavar="ACCOUNT", help="its id: up to 64 of a-z, 0-9 and -")
        action.add_argument("--name", metavar="TEXT", help="free text (the id)")
        for name, (_, meaning) in LIMITS.items():
            text = f"{meaning}; '{USUAL}' = as for every account"
            action.add_argument(f"--{name.replace('_', '-')}", metavar="N", help=text)
    audit = actions.add_parser("audit", help="list who asked for which change and what came of it, newest first")
    audit.add_argument("--account", metavar="ACCOUNT", help="only of this account")
    audit.add_argument("--limit", type=int, default=100, metavar="N", help="at most so many (100)")
    for action in (create, change, audit, actions.add_parser("list", help="list all accounts, what is set of them")):
        _json(action)
    export = actions.add_parser("export", help="write all that an account has into a folder")
    export.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder to make")
    delete = actions.add_parser("delete", help="delete all that an account has, revoke its keys and close it")
    delete.add_argument("--yes", action="store_true", help="it is meant")
    for action in (export, delete):
        action.add_argument("id", metavar="ACCOUNT", help="its id")


def _keys(actions: Commands[argparse.ArgumentParser]) -> None:
    create = actions.add_parser("create", help="make a key and print it: it is shown once")
    create.add_argument("name", metavar="NAME", help="who it is for")
    create.add_argument("--account", metavar="ACCOUNT", help="whose it is (default, while there is no other account)")
    create.add_argument(
        "--scopes", metavar="NAMES", help="of read, submit, review, manage, admin, with commas (read,submit,review)"
    )
    create.add_argument("--days", type=float, metavar="N", help="it ends after so long (never)")
    rotate = actions.add_parser("rotate", help="replace a key by a new one of the same account, and print that")
    rotate.add_argument("name", metavar="ID")
    rotate.add_argument("--keep-hours", type=float, default=0.0, metavar="N", help="the old one ends after so long (0)")
    revoke = actions.add_parser("revoke", help="end a key")
    revoke.add_argument("name", metavar="ID")
    listing = actions.add_parser("list", help="list all keys")
    listing.add_argument("--account", metavar="ACCOUNT", help="only those of this account")
    for action in (create, rotate, revoke, listing):
        _json(action)


def _webhooks(actions: Commands[argparse.ArgumentParser]) -> None:
    create = actions.add_parser("create", help="send events of an account to an address, and print the secret once")
    create.add_argument("target", metavar="URL", help="https, and public unless BLADEATLAS_OUTBOUND_NETWORKS has it")
    create.add_argument("--account", metavar="ACCOUNT", help="whose it is (default, while there is no other account)")
    create.add_argument("--types", metavar="NAMES", help="events that are sent, with commas (all)")
    create.add_argument("--description", default="", metavar="TEXT", help="free text")
    rotate = actions.add_parser("rotate", help="replace a secret, and print the new one")
    rotate.add_argument(
        "--keep-hours", type=float, default=24.0, metavar="N", help="messages are signed with the old one too (24)"
    )
    test = actions.add_parser("test", help="send a test message")
    deliveries = actions.add_parser("deliveries", help="list what was sent and what came of it, newest first")
    deliveries.add_argument("--limit", type=int, default=50, metavar="N", help="at most so many (50)")
    redeliver = actions.add_parser("redeliver", help="send a message once more")
    delete = actions.add_parser("delete", help="remove a webhook")
    for action in (rotate, test, deliveries, redeliver, delete):
        action.add_argument("target", metavar="ID", help="of the webhook")
    redeliver.add_argument("delivery", metavar="DELIVERY", help="its id")
    listing = actions.add_parser("list", help="list all webhooks")
    listing.add_argument("--account", metavar="ACCOUNT", help="only those of this account")
    for action in (create, rotate, test, deliveries, redeliver, delete, listing):
        _json(action)


def _add(commands: Commands[argparse.ArgumentParser], name: str, text: str) -> Commands[argparse.ArgumentParser]:
    command = commands.add_parser(name, help=text, description=text[0].upper() + text[1:] + ".")
    command.set_defaults(module=f"cli.{name}", function="command")
    return command.add_subparsers(required=True, dest="action", metavar="ACTION")


def _json(action: argparse.ArgumentParser) -> None:
    action.add_argument("--json", action="store_true", help="print JSON")
