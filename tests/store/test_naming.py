"""Metadata on both databases."""

from __future__ import annotations

import pytest

from core.errors import BadInput
from core.settings import make_settings
from store.account_data import AccountData
from store.account_models import DEFAULT_ACCOUNT
from store.accounts import Accounts
from store.db import Database
from store.inspections import Inspections
from store.listing import Filter, list_inspections
from store.naming import Naming, rename
from store.plan import Plan
from tests.store.small_plan import FILES, GRAPH


def found(db: Database, owner: str = DEFAULT_ACCOUNT, **metadata: str) -> list[str]:
    return [row.id for row in list_inspections(db, Filter(owner, metadata=metadata), 10, None).rows]


def test_metadata_chooses_within_an_account(db: Database) -> None:
    inspections = Inspections(db, GRAPH)
    for name, owner, serial in (("a", DEFAULT_ACCOUNT, "1"), ("b", DEFAULT_ACCOUNT, "2"), ("c", "shop", "1")):
        inspections.create(name, FILES, make_settings(), "", owner=owner, metadata={"engine_serial": serial})
    assert (found(db, engine_serial="1"), found(db, "shop", engine_serial="1")) == (["a"], ["c"])
    assert found(db, engine_serial="1", module="HPT") == []
    rename(db, "a", Naming(metadata={"module": "HPT"}))
    assert found(db, engine_serial="1", module="HPT") == ["a"]
    assert inspections.get("a").metadata == {"engine_serial": "1", "module": "HPT"}
    with pytest.raises(BadInput, match="at most 32"):
        rename(db, "a", Naming(label="x", metadata={f"n{number}": "1" for number in range(31)}))
    assert inspections.get("a").label == ""


def test_metadata_is_exported_and_deleted_with_the_account(db: Database) -> None:
    Accounts(db).create("shop")
    Inspections(db, GRAPH).create("c", FILES, make_settings(), "", owner="shop", metadata={"inspector": "Eve"})
    data = AccountData(db, "shop")
    assert data.record()["inspections"][0]["metadata"] == {"inspector": "Eve"}
    data.delete(Plan(db, GRAPH))
    assert Inspections(db, GRAPH).get("c").metadata == {}
