"""Accounts, keys with scopes and an end, sessions and the audit log, on SQLite and PostgreSQL."""

from __future__ import annotations

from datetime import timedelta
from typing import Any

import pytest
from sqlalchemy import select, update

from core.errors import BadInput
from core.settings import make_settings
from store.account_data import AccountData
from store.account_models import ApiKey, AuditEntry, Scope, WebSession
from store.accounts import Accounts
from store.audit import AuditFilter, AuditLog, Deed, audited
from store.db import Database
from store.files import Stored
from store.housekeeping import Retention
from store.inspections import Inspections
from store.keys import KeyRing, Keys, parse_scopes, utc_now
from store.models import Inspection, Task
from store.plan import Plan
from store.publishing import Publishing
from store.records import InputFiles
from store.settings import DeploymentSettings
from store.web_sessions import SESSION_LENGTH, WebSessions
from tests.store.small_plan import FILES, GRAPH, result_for

DAY = timedelta(days=1)


def run(db: Database, name: str, **more: Any) -> list[bool]:
    """Run an inspection to its end; for each task whether a finished result was taken up."""
    with db.write() as session:
        Inspections(db, GRAPH).create_in(session, name, FILES, make_settings(), "", **more)
    plan = Plan(db, GRAPH)
    while (lease := plan.lease("me", inspection_id=name)) is not None:
        assert plan.complete(lease, result_for(lease))
    with db.read() as session:
        return list(session.scalars(select(Task.reused).where(Task.inspection_id == name)))


@pytest.mark.parametrize("name", ["", "-a", "A", "a b", "a" * 65, "ä", "a\0"])
def test_an_id_of_another_form_is_refused(db: Database, name: str) -> None:
    with pytest.raises(BadInput, match="no id of an account"):
        Accounts(db).create(name)
    with pytest.raises(BadInput, match="there is no account"):
        Accounts(db).get(name)


def test_limits_are_set_and_taken_back(db: Database) -> None:
    accounts, settings = Accounts(db), DeploymentSettings(max_active_per_owner=7, retention_days=30)
    made = accounts.create("shop", "The shop", max_active=3, retention_days=0)
    assert (made.name, made.max_active, made.max_priority, accounts.get("shop")) == ("The shop", 3, 9, made)
    assert accounts.limits("shop", settings)["max_active_per_owner"] == 3
    assert accounts.retention_days("shop", settings) == 0
    changed = accounts.change("shop", max_active=None, max_priority=2)
    assert (changed.max_active, changed.max_priority, changed.retention_days) == (None, 2, 0)
    assert accounts.limits("shop", settings)["max_active_per_owner"] == 7
    for wrong in ({"max_active": 0}, {"max_priority": 10}, {"retention_days": float("nan")}, {"max_kept_bytes": -1}):
        with pytest.raises(BadInput, match=next(iter(wrong))):
            accounts.change("shop", **wrong)
    with pytest.raises(BadInput, match="already"):
        accounts.create("shop")


def test_a_key_has_scopes_and_an_end(db: Database) -> None:
    Accounts(db).create("shop")
    keys = Keys(db)
    view, text = keys.create("station", "shop", [Scope.SUBMIT, Scope.READ], utc_now() + DAY)
    assert (view.account_id, view.scopes) == ("shop", (Scope.READ, Scope.SUBMIT))
    ring = KeyRing(keys)
    ring.refresh()
    assert ring.find(text) == view
    assert view.ended(utc_now()) is None
    assert view.ended(utc_now() + 2 * DAY) == "has expired"
    for until in (utc_now(), utc_now() + 40_000 * DAY):
        with pytest.raises(BadInput, match="within 100 years"):
            keys.create("late", "shop", expires_at=until)
    for account in ("nobody", "\0"):
        with pytest.raises(BadInput, match="there is no account"):
            keys.create("x", account)
    with pytest.raises(BadInput, match="did you mean 'submit'"):
        parse_scopes(["sumbit"])


def test_a_rotated_key_is_followed_by_its_like(db: Database) -> None:
    keys = Keys(db)
    old, _ = keys.create("station", scopes=[Scope.READ], expires_at=utc_now() + 10 * DAY)
    new, _ = keys.rotate(old.id, timedelta(hours=2))
    assert (new.name, new.account_id, new.scopes) == (old.name, old.account_id, old.scopes)
    assert new.expires_at is not None
    assert abs(new.expires_at - new.created_at - 10 * DAY) < timedelta(minutes=1)
    kept = keys.get(old.id)
    assert kept.ended(utc_now()) is None
    assert kept.ended(utc_now() + timedelta(hours=3)) == "has expired"
    keys.rotate(new.id)
    assert keys.get(new.id).ended(utc_now()) == "was revoked"
    with pytest.raises(BadInput, match="was revoked"):
        keys.rotate(new.id)


def test_a_session_ends_by_its_time_and_with_its_key(db: Database) -> None:
    keys, sessions = Keys(db), WebSessions(db)
    long, short = keys.create("long")[0], keys.create("short", expires_at=utc_now() + timedelta(hours=1))[0]
    (one, until), (other, sooner) = sessions.begin(long.id), sessions.begin(short.id)
    assert timedelta(0) <= utc_now() + SESSION_LENGTH - until < timedelta(minutes=1)
    assert sooner == short.expires_at
    assert (sessions.find(one), sessions.find(other), sessions.find("x")) == (long.id, short.id, None)
    with db.read() as session:
        assert one not in str([vars(row) for row in session.scalars(select(WebSession))])
    sessions.end(other)
    assert sessions.find(other) is None
    with db.write() as session:
        session.execute(update(WebSession).values(expires_at=db.now(session)))
    assert sessions.find(one) is None
    Retention(db).tidy()
    with db.read() as session:
        assert session.scalars(select(WebSession)).all() == []


def test_results_are_taken_up_within_an_account_only(db: Database) -> None:
    assert not any(run(db, "mine", owner="me", reuse_account="me"))
    assert not any(run(db, "yours", owner="you", reuse_account="you"))
    assert all(run(db, "mine again", owner="me", reuse_account="me"))
    assert not any(run(db, "shared")), "what an account has made for itself is not shared"
    assert all(run(db, "shared again", owner="else"))


def test_an_account_may_keep_its_inspections_for_another_time(db: Database) -> None:
    Accounts(db).create("short", retention_days=1)
    Accounts(db).create("ever", retention_days=0)
    for name, owner in (("a", "short"), ("b", "ever"), ("c", "default")):
        run(db, name, owner=owner)
    publishing = Publishing(db, retention_days=30)
    while (ticket := publishing.take("me")) is not None:
        assert publishing.finish(ticket, [Stored("summary.json", 5, "0" * 64)], {})
    with db.read() as session:
        rows = session.scalars(select(Inspection).order_by(Inspection.id)).all()
    days = [row.expires_at and round((row.expires_at - row.updated_at) / DAY) for row in rows]
    assert (days, [row.published_bytes for row in rows]) == ([1, None, 30], [5, 5, 5])


def test_all_that_an_account_has_is_told_and_deleted(db: Database) -> None:
    Accounts(db).create("shop")
    key, text = Keys(db).create("station", "shop")
    run(db, "done", owner="shop", label="blade 4")
    run(db, "other's")
    with db.write() as session:
        files, further = InputFiles("v", "0" * 64, "a", "1" * 64), InputFiles("w", "2" * 64, None, None)
        Inspections(db, GRAPH).create_in(session, "waiting", [files, further], make_settings(), "", owner="shop")
    AuditLog(db).write(Deed("shop", key.id, "POST /v1/inspections", "/v1/inspections", 202, "", "r"))
    data = AccountData(db, "shop")
    record = data.record()
    assert [one["label"] for one in record["inspections"]] == ["blade 4", ""]
    assert [one["id"] for one in record["keys"]] == [key.id]
    assert [one["status"] for one in record["audit"]] == [202]
    assert text.rsplit("_", 1)[1] not in str(record)
    assert {(file.inspection_id, file.path) for file in data.files()} >= {
        ("done", "inputs/video"),
        ("waiting", "inputs/annotations"),
        ("waiting", "inputs/1/video"),
    }
    plan = Plan(db, GRAPH)
    assert sorted(data.delete(plan)) == ["done", "waiting"]
    assert data.delete(plan) == [], "harmless when it is repeated"
    assert Accounts(db).get("shop").closed_at is not None
    assert Keys(db).get(key.id).ended(utc_now()) == "was revoked"
    with db.read() as session:
        rows = {row.id: row for row in session.scalars(select(Inspection))}
    assert {name for name, row in rows.items() if row.deleted_at is None} == {"other's"}
    assert (rows["waiting"].state, rows["done"].label) == ("cancelled", "")
    with pytest.raises(BadInput, match="was closed"):
        Keys(db).create("x", "shop")
    assert data.record()["inspections"] == []
    AccountData(db, "default").delete(plan)
    assert Accounts(db).get("default").closed_at is None


def test_entries_of_the_log_are_kept_for_their_time(db: Database) -> None:
    log = AuditLog(db)
    for number in range(5):
        log.write(Deed("shop" if number % 2 else "", "", "POST /v1/x", f"/v1/{number}\x1b\n", 200, "", ""))
    pages = [log.page(AuditFilter(), 2)]
    while pages[-1].cursor is not None:
        pages.append(log.page(AuditFilter(), 2, pages[-1].cursor))
    assert [[entry.target[:5] for entry in page.entries] for page in pages] == [
        ["/v1/4", "/v1/3"],
        ["/v1/2", "/v1/1"],
        ["/v1/0"],
    ]
    assert pages[0].entries[0].target == "/v1/4??"
    assert len(log.page(AuditFilter("shop"), 10).entries) == 2
    assert log.page(AuditFilter(since=utc_now() + DAY), 10).entries == []
    with db.write() as session:
        old = select(AuditEntry.id).order_by(AuditEntry.id).limit(3)
        aged = update(AuditEntry).where(AuditEntry.id.in_(old.scalar_subquery()))
        session.execute(aged.values(at=db.now(session) - 8 * DAY), execution_options={"synchronize_session": False})
    Retention(db, audit_days=7).tidy()
    assert len(log.page(AuditFilter(), 10).entries) == 2


def test_a_command_comes_into_the_log_with_its_outcome(db: Database) -> None:
    with audited(db, "keys create", "station"):
        Keys(db).create("station")
    with pytest.raises(BadInput), audited(db, "keys revoke", "nobody"):
        Keys(db).revoke("nobody")
    entries = AuditLog(db).page(AuditFilter(), 10).entries
    assert [(entry.action, entry.target, entry.status, entry.code) for entry in entries] == [
        ("bladeatlas keys revoke", "nobody", 422, "unknown_key"),
        ("bladeatlas keys create", "station", 200, ""),
    ]
    with db.read() as session:
        (digest,) = session.scalars(select(ApiKey.digest)).all()
    assert digest not in str(entries)
