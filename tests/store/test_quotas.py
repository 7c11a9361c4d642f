"""Quotas of accounts hold however many ask at once, on SQLite and PostgreSQL."""

from __future__ import annotations

import uuid
from collections import Counter
from collections.abc import Callable
from datetime import timedelta
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import select, update

from core.settings import make_settings
from store.account_models import RequestCount
from store.accounts import Accounts
from store.admission import Admission, LimitReached
from store.db import Database
from store.housekeeping import Retention
from store.inspections import Inspections, mark_deleted
from store.models import Inspection, Upload
from store.records import InputFiles
from store.request_rate import RequestRate
from store.settings import DeploymentSettings
from store.uploads import Uploads
from tests.store.small_plan import GRAPH
from tests.store.test_admission import AT_ONCE, admission_of, count, outcomes

MIB = 1 << 20


def inspect(admission: Admission, owner: str, size: int) -> None:
    digest = uuid.uuid4().hex * 2
    with admission.place(owner, size) as place, admission.db.write() as session:
        place.use(session)
        files, name = InputFiles("v", digest, None, None), digest[:32]
        inspections = Inspections(admission.db, GRAPH)
        inspections.create_in(session, name, [files], make_settings(), "", owner=owner, input_bytes=place.input_bytes)


def upload(admission: Admission, folder: Path, owner: str, size: int) -> None:
    Uploads(admission.db, folder).create(owner, size, {}, partial(admission.admit_upload, owner=owner, size=size))


def both(call: Callable[[str], None]) -> list[Callable[[], object]]:
    """As many calls for each of two accounts."""
    return [partial(call, owner) for owner in ("me", "you") for _ in range(AT_ONCE // 2)]


@pytest.fixture
def accounts(db: Database) -> Accounts:
    made = Accounts(db)
    for name in ("me", "you"):
        made.create(name)
    return made


def test_an_account_may_have_a_limit_of_its_own(db: Database, tmp_path: Path, accounts: Accounts) -> None:
    admission = admission_of(db, tmp_path, max_active_per_owner=3)
    accounts.change("me", max_active=1)
    found = outcomes(both(lambda owner: inspect(admission, owner, 0)))
    assert found == {"admitted": 4, "too_many_active_of_owner": AT_ONCE - 4}
    with db.read() as session:
        assert Counter(session.scalars(select(Inspection.owner))) == {"me": 1, "you": 3}
    accounts.change("me", max_active=None)
    inspect(admission, "me", 0)


def test_who_has_too_many_uploads_is_refused_without_a_turn_to_write(
    db: Database, tmp_path: Path, accounts: Accounts
) -> None:
    accounts.change("me", max_open_uploads=1)
    admission = admission_of(db, tmp_path)
    admission.look_upload("me")
    upload(admission, tmp_path, "me", 1)
    with db.write() as session:  # nobody else can write meanwhile
        db.lock(session, 1)
        for refused in (partial(admission.look_upload, "me"), partial(admission.promise_form, "me", 1)):
            with pytest.raises(LimitReached, match="max_open_uploads_per_owner is 1"):
                refused()
    admission.look_upload("you")


def test_no_more_bytes_are_promised_to_an_account_than_may(db: Database, tmp_path: Path, accounts: Accounts) -> None:
    admission = admission_of(db, tmp_path, max_promised_bytes_per_owner=5 * MIB, max_promised_bytes=9 * MIB)
    accounts.change("you", max_promised_bytes=3 * MIB)
    found = outcomes(both(lambda owner: upload(admission, tmp_path / "up", owner, MIB)))
    assert found == {"admitted": 8, "too_many_promised_bytes_of_owner": AT_ONCE - 8}
    form = admission.promise_form("else", MIB)
    with pytest.raises(LimitReached, match="max_promised_bytes is ") as caught:
        admission.promise_form("else", 1)
    assert (caught.value.code, caught.value.where) == ("too_many_promised_bytes", "max_promised_bytes")
    with pytest.raises(LimitReached):
        form.keep(MIB + 1)
    with db.write() as session:  # all have come: nothing is promised any more
        session.execute(update(Upload).values(offset=Upload.length))
    upload(admission, tmp_path / "up", "me", 5 * MIB)


def test_no_more_is_kept_than_may(db: Database, tmp_path: Path, accounts: Accounts) -> None:
    admission = admission_of(db, tmp_path, max_kept_bytes_per_owner=10 * MIB)
    accounts.change("you", max_kept_bytes=4 * MIB)
    found = outcomes(both(lambda owner: inspect(admission, owner, MIB)))
    assert found == {"admitted": 14, "too_many_kept_bytes_of_owner": AT_ONCE - 14}
    with db.read() as session:
        assert Counter(session.scalars(select(Inspection.owner))) == {"me": 10, "you": 4}
        one = session.scalars(select(Inspection.id).where(Inspection.owner == "me")).first()
    with pytest.raises(LimitReached, match="max_kept_bytes_per_owner is 10485760") as caught:
        upload(admission, tmp_path / "up", "me", 1)
    assert caught.value.where == "max_kept_bytes_per_owner"
    assert one is not None
    mark_deleted(db, one)
    upload(admission, tmp_path / "up", "me", MIB)
    with pytest.raises(LimitReached):
        inspect(admission, "me", 1)  # what is promised will be kept


def test_published_files_are_kept_bytes(db: Database, tmp_path: Path) -> None:
    admission = admission_of(db, tmp_path, max_kept_bytes=10 * MIB)
    inspect(admission, "me", MIB)
    inspect(admission, "you", MIB)
    with db.write() as session:
        session.execute(update(Inspection).where(Inspection.owner == "me").values(published_bytes=8 * MIB))
    with pytest.raises(LimitReached) as caught:
        inspect(admission, "you", 1)
    assert (caught.value.code, caught.value.where) == ("too_many_kept_bytes", "max_kept_bytes")
    admission.look("you")


class Clock:
    """Time of a server as the test says it is."""

    now = 0.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def early_in_a_minute(db: Database, monkeypatch: pytest.MonkeyPatch) -> None:
    """The database's clock stands a second behind a full minute."""
    with db.read() as session:
        moment = db.now(session).replace(second=1, microsecond=0)
    monkeypatch.setattr(Database, "now", lambda *_: moment)


def rate_of(db: Database, clock: Clock, **limits: Any) -> RequestRate:
    return RequestRate(db, DeploymentSettings().model_copy(update=limits), clock)


@pytest.mark.usefixtures("early_in_a_minute")
def test_requests_of_a_minute_are_counted_over_all_servers(db: Database, accounts: Accounts) -> None:
    accounts.change("me", max_requests_per_minute=40)
    clock = Clock()
    servers = [rate_of(db, clock, max_requests_per_minute_per_owner=20) for _ in range(2)]
    calls = [partial(servers[n % 2].spend_slowly, owner) for n in range(AT_ONCE) for owner in ("me", "you")]
    found = outcomes([*calls, *calls[:20]])
    assert set(found) == {"admitted", "too_many_requests_of_owner"}
    assert found["admitted"] == 60, "all of both limits are used, and no more"
    with pytest.raises(LimitReached, match=r"max_requests_per_minute_per_owner.* in 59 s|60 s") as caught:
        servers[0].spend("me")
    assert caught.value.retry_after_s in (59, 60)
    assert caught.value.where == "max_requests_per_minute_per_owner"


@pytest.mark.usefixtures("early_in_a_minute")
def test_a_limit_for_all_together(db: Database, accounts: Accounts) -> None:
    rate = rate_of(db, Clock(), max_requests_per_minute=30)
    found = outcomes(both(rate.spend_slowly))
    assert found == {"admitted": 30, "too_many_requests": AT_ONCE - 30}


def test_the_next_minute_begins_anew(db: Database, monkeypatch: pytest.MonkeyPatch) -> None:
    clock = Clock()
    rate = rate_of(db, clock, max_requests_per_minute_per_owner=1)
    rate.spend_slowly("me")
    with pytest.raises(LimitReached):
        rate.spend_slowly("me")
    with db.read() as session:
        later = db.now(session) + timedelta(minutes=1)
    monkeypatch.setattr(Database, "now", lambda *_: later)
    clock.now = 61.0
    rate.spend_slowly("me")
    monkeypatch.setattr(Database, "now", lambda *_: later + timedelta(minutes=10))
    Retention(db).tidy()
    assert count(db, RequestCount) == 0


def test_without_a_limit_nothing_is_counted(db: Database) -> None:
    rate = rate_of(db, Clock())
    for _ in range(3):
        rate.spend_slowly("me")
    assert rate.spend("me")
    assert count(db, RequestCount) == 0
