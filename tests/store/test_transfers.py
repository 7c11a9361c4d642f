"""Leases on transfers, and the uploads that end with them, on both databases."""

from __future__ import annotations

from datetime import timedelta
from pathlib import Path

import pytest
from sqlalchemy import select
from sqlalchemy.orm import Session

from core.errors import BadInput, BladeAtlasError, DiskFull
from store.account_data import AccountData
from store.admission import LimitReached
from store.db import Database
from store.housekeeping import Retention
from store.integration_models import Transfer, TransferFile, TransferState
from store.models import Upload
from store.outbound import Unreachable
from store.plan import Plan
from store.transfers import KEPT_S, TransferLease, TransferLost, Transfers, TransferView, WantedFile
from store.uploads import Uploads
from tests.store.small_plan import GRAPH

FILES = (WantedFile("https://files.test/video", "0" * 64, 1 << 40), WantedFile("s3://incoming/notes", None, 100))


@pytest.fixture
def transfers(db: Database) -> Transfers:
    return Transfers(db)


@pytest.fixture
def uploads(db: Database, tmp_path: Path) -> Uploads:
    return Uploads(db, tmp_path / "uploads")


def begun(transfers: Transfers, owner: str = "default") -> TransferLease:
    lease = transfers.begin("one", owner, FILES, "first")
    assert lease is not None
    return lease


def found(transfers: Transfers) -> TransferView:
    view = transfers.find("one")
    assert view is not None
    return view


def let_pass(transfers: Transfers, seconds: float) -> None:
    """Leases and requests are so much older."""
    with transfers.db.write() as session:
        for row in session.scalars(select(Transfer)):
            row.asked_at -= timedelta(seconds=seconds)
            if row.lease_expires_at is not None:
                row.lease_expires_at -= timedelta(seconds=seconds)


def put_upload(transfers: Transfers, uploads: Uploads, lease: TransferLease, name: str, number: int = 0) -> int | None:
    """A new upload for a file; the length of the one that it replaces."""
    replaced: list[int | None] = []

    def admit(session: Session) -> None:
        replaced.append(transfers.set_upload(session, lease, number, name, f'"{name}"'))

    uploads.create(lease.owner, 1000, {}, admit, name)
    return replaced[0]


def living(transfers: Transfers) -> set[str]:
    with transfers.db.read() as session:
        return set(session.scalars(select(Upload.id).where(Upload.removed_at.is_(None))))


def test_a_transfer_is_begun_once_and_leased_to_one(transfers: Transfers) -> None:
    lease = begun(transfers)
    assert [(file.url, file.sha256, file.most_bytes, file.number, file.upload_id) for file in lease.files] == [
        ("https://files.test/video", "0" * 64, 1 << 40, 0, None),
        ("s3://incoming/notes", None, 100, 1, None),
    ]
    assert transfers.begin("one", "default", FILES, "second") is None
    assert transfers.take("one", "second") is None
    assert (found(transfers).state, found(transfers).free) == (TransferState.FETCHING, False)
    let_pass(transfers, 31)
    assert found(transfers).free
    assert transfers.renew(lease), "as long as nobody took it over it is held"
    assert transfers.take("one", "second") is None
    assert transfers.take("another", "second") is None
    assert transfers.find("another") is None


def test_the_leases_of_a_holder_that_is_gone_are_free_at_once(transfers: Transfers) -> None:
    begun(transfers)
    transfers.take_over("second")
    assert not found(transfers).free
    transfers.take_over("first")
    assert found(transfers).free
    assert transfers.take("one", "first") is not None


def test_who_lost_the_lease_writes_nothing(transfers: Transfers, uploads: Uploads) -> None:
    old = begun(transfers)
    put_upload(transfers, uploads, old, "a")
    let_pass(transfers, 31)
    new = transfers.take("one", "second")
    assert new is not None
    assert (new.fence, new.files[0].upload_id, new.files[0].tag) == (2, "a", '"a"')
    assert not transfers.renew(old)
    assert not transfers.finish(old)
    assert transfers.refuse(old, 0, BadInput("too late")) == []
    with pytest.raises(TransferLost):
        transfers.set_tag(old, 0, "x")
    with pytest.raises(TransferLost):
        put_upload(transfers, uploads, old, "b")
    assert living(transfers) == {"a"}
    assert transfers.renew(new)
    assert transfers.finish(new)
    assert found(transfers).state == TransferState.FETCHED


def test_an_upload_takes_the_place_of_another_in_one_step(transfers: Transfers, uploads: Uploads) -> None:
    lease = begun(transfers)
    assert put_upload(transfers, uploads, lease, "a") is None
    uploads.commit("a", 400)
    assert (found(transfers).came, found(transfers).size) == (400, 1000)
    assert put_upload(transfers, uploads, lease, "b") == 1000
    assert living(transfers) == {"b"}
    uploads.remove("b")
    assert put_upload(transfers, uploads, lease, "c") is None, "it gave its place up before"
    assert put_upload(transfers, uploads, lease, "d", number=1) is None
    assert (found(transfers).uploads, found(transfers).size) == (("c", "d"), 2000)

    def full(session: Session) -> None:
        transfers.set_upload(session, lease, 0, "e", "")
        raise LimitReached("no more")

    with pytest.raises(LimitReached):
        uploads.create("default", 10, {}, full, "e")
    assert found(transfers).uploads == ("c", "d")
    assert living(transfers) == {"c", "d"}


@pytest.mark.parametrize(
    "error",
    [
        BadInput("it is too large", code="too_large", where="url"),
        Unreachable("it does not answer", where="url"),
        LimitReached("no more", code="too_many_uploads", where="max_open_uploads"),
        DiskFull("no space"),
    ],
)
def test_an_error_is_kept_as_it_was_and_ends_the_uploads(
    transfers: Transfers, uploads: Uploads, error: BladeAtlasError
) -> None:
    lease = begun(transfers)
    put_upload(transfers, uploads, lease, "a")
    assert transfers.refuse(lease, 1, error) == ["a"]
    view = found(transfers)
    assert (view.state, view.free, view.failed) == (TransferState.REFUSED, False, 1)
    assert type(view.error) is type(error)
    assert view.error is not None
    assert view.error.to_dict() == error.to_dict()
    assert living(transfers) == set()
    assert transfers.take("one", "second") is None
    transfers.end("one")
    assert transfers.find("one") is None
    begun(transfers)


def test_what_is_over_ends_with_its_uploads_and_what_is_under_way_does_not(
    transfers: Transfers, uploads: Uploads
) -> None:
    lease = begun(transfers)
    put_upload(transfers, uploads, lease, "a")
    assert transfers.end("one") == []
    assert transfers.finish(lease)
    assert transfers.end("one") == ["a"]
    assert transfers.find("one") is None
    assert living(transfers) == set()
    with transfers.db.read() as session:
        assert session.scalars(select(TransferFile)).all() == []


@pytest.mark.parametrize(
    ("fetched", "seconds", "forgotten"),
    [(True, KEPT_S - 60, 0), (True, KEPT_S + 1, 1), (False, KEPT_S + 1, 1)],
    ids=["just fetched", "not taken up", "its holder died"],
)
def test_what_nobody_asks_for_again_ends(
    transfers: Transfers, uploads: Uploads, fetched: bool, seconds: float, forgotten: int
) -> None:
    lease = begun(transfers)
    put_upload(transfers, uploads, lease, "a")
    assert not fetched or transfers.finish(lease)
    let_pass(transfers, seconds)
    assert Retention(transfers.db).expire_transfers() == forgotten
    assert len(living(transfers)) == 1 - forgotten
    assert (transfers.find("one") is None) == bool(forgotten)


def test_what_is_still_fetched_goes_on_though_nobody_asks(transfers: Transfers) -> None:
    lease = begun(transfers)
    let_pass(transfers, KEPT_S + 1)
    assert transfers.renew(lease)
    assert Retention(transfers.db).expire_transfers() == 0
    assert transfers.finish(lease)


def test_asking_again_keeps_it_and_comes_too_late_once(transfers: Transfers, uploads: Uploads) -> None:
    lease = begun(transfers)
    put_upload(transfers, uploads, lease, "a")
    transfers.finish(lease)
    for _ in range(3):
        let_pass(transfers, KEPT_S - 60)
        assert transfers.ask("one") == []
    let_pass(transfers, KEPT_S + 1)
    assert transfers.ask("one") == ["a"]
    assert transfers.ask("one") == []
    assert living(transfers) == set()


def test_the_transfers_of_an_account_end_with_it(transfers: Transfers, uploads: Uploads) -> None:
    lease = begun(transfers)
    put_upload(transfers, uploads, lease, "a")
    AccountData(transfers.db, "default").delete(Plan(transfers.db, GRAPH))
    assert transfers.find("one") is None
    assert not transfers.renew(lease)
    assert living(transfers) == set()
    assert not transfers.finish(lease)
