"""`bladeatlas init`: what has to be there before the first server starts; harmless at any later time."""

from __future__ import annotations

import argparse

from cli.terminal import say
from store import json_log
from store.audit import audited
from store.environment import deployment_settings
from store.factory import open_artifacts, open_database
from store.keys import Keys

_NAME = "first key"


def command(parsed: argparse.Namespace) -> int:
    """Migrate the database, make the artifact store, and print the first API key, the only line on standard output.

    A key is made once in the life of a database: whoever lost it makes another with `bladeatlas keys create`.
    """
    settings = deployment_settings()
    json_log.configure()
    database = open_database(settings)
    try:
        open_artifacts(settings).prepare()
        with audited(database, "init", _NAME):
            made = Keys(database).create_first(_NAME)
        if made is None:
            say("tables and artifact store are there; keys too, so none was made", error=True)
        else:
            view, key = made
            say(key)
            say(f"the first key, of the account '{view.account_id}' ({', '.join(view.scopes)}); shown once", error=True)
    finally:
        database.close()
    return 0
