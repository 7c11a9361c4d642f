"""Signed links, on SQLite and PostgreSQL."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from datetime import timedelta

import pytest

from core.errors import BadInput
from core.settings import make_settings
from store.account_data import AccountData
from store.accounts import Accounts
from store.db import Database
from store.inspections import Inspections
from store.links import LONGEST, Links
from store.plan import Plan
from store.records import InputFiles
from tests.store.small_plan import GRAPH

PATH = "artifacts/mapping/mesh.ply"
HOUR = timedelta(hours=1)


@pytest.fixture
def links(db: Database) -> Links:
    for account in ("mine", "others"):
        Accounts(db).create(account)
        with db.write() as session:
            files = [InputFiles("inputs/0/video", "0" * 64, None, None)]
            Inspections(db, GRAPH).create_in(session, f"of-{account}", files, make_settings(), "", owner=account)
    return Links(db)


def test_a_link_opens_one_thing_of_one_inspection(links: Links) -> None:
    signed = links.sign("mine", "of-mine", PATH, HOUR)
    assert links.owner("of-mine", PATH, signed) == "mine"
    assert links.owner("of-mine", PATH + "x", signed) is None
    assert links.owner("of-others", PATH, signed) is None
    links.sign("others", "of-others", PATH, HOUR)
    assert links.owner("of-others", PATH, signed) is None
    assert links.owner("of-mine", PATH, replace(signed, expires=signed.expires + 1)) is None
    assert links.owner("of-mine", PATH, replace(signed, signature="0" * 64)) is None


def test_a_link_ends_with_its_time_and_with_its_accounts_secret(links: Links) -> None:
    assert links.owner("of-mine", PATH, links.sign("mine", "of-mine", PATH, timedelta(seconds=-1))) is None
    longest = links.sign("mine", "of-mine", PATH, timedelta(days=10_000))
    assert longest.expires - links.sign("mine", "of-mine", PATH, LONGEST).expires <= 1
    others = links.sign("others", "of-others", PATH, HOUR)
    links.revoke("mine")
    assert links.owner("of-mine", PATH, longest) is None
    assert links.owner("of-mine", PATH, links.sign("mine", "of-mine", PATH, HOUR)) == "mine"
    assert links.owner("of-others", PATH, others) == "others"
    AccountData(links.db, "others").delete(Plan(links.db, GRAPH))
    assert links.owner("of-others", PATH, others) is None
    with pytest.raises(BadInput):
        links.sign("others", "of-others", PATH, HOUR)


def test_first_links_at_once_are_signed_with_one_secret(links: Links) -> None:
    with ThreadPoolExecutor(8) as threads:
        signed = list(threads.map(lambda _: links.sign("mine", "of-mine", PATH, HOUR), range(8)))
    assert {links.owner("of-mine", PATH, one) for one in signed} == {"mine"}
