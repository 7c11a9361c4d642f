"""Limits hold however many ask at once: threads, processes, on SQLite and PostgreSQL."""

from __future__ import annotations

import shutil
import threading
import uuid
from collections import Counter
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from datetime import timedelta
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import func, select, update

from core.errors import BladeAtlasError, DiskFull
from core.settings import make_settings
from store.admission import Admission, LimitReached
from store.db import Database
from store.housekeeping import Retention
from store.inspections import Inspections
from store.models import Inspection, Reservation, Upload
from store.records import InputFiles
from store.settings import DeploymentSettings
from store.uploads import Uploads
from tests.store.small_plan import GRAPH

GIB = 1 << 30
AT_ONCE = 50


def admission_of(db: Database, tmp_path: Path, **limits: Any) -> Admission:
    return Admission(db, DeploymentSettings(data_dir=tmp_path, reserve_bytes=0).model_copy(update=limits))


@pytest.fixture
def free(monkeypatch: pytest.MonkeyPatch) -> Callable[[int], None]:
    """Says how much space the disk has."""

    def set_free(size: int) -> None:
        usage = type(shutil.disk_usage("/"))(size * 2, size, size)
        monkeypatch.setattr("store.admission.shutil.disk_usage", lambda _folder: usage)

    return set_free


def outcomes(calls: list[Callable[[], object]]) -> Counter[str]:
    """Make all calls at the same moment; what came of them."""
    barrier = threading.Barrier(len(calls))

    def run(call: Callable[[], object]) -> str:
        barrier.wait(30)
        try:
            call()
        except BladeAtlasError as error:
            return error.code
        return "admitted"

    with ThreadPoolExecutor(len(calls)) as pool:
        return Counter(pool.map(run, calls))


def create(admission: Admission, owner: str) -> None:
    digest = uuid.uuid4().hex * 2
    with admission.place(owner) as place, admission.db.write() as session:
        place.use(session)
        Inspections(admission.db, GRAPH).create_in(
            session, digest[:32], [InputFiles("v", digest, None, None)], make_settings(), "", owner=owner
        )


def count(db: Database, table: type[Any]) -> int:
    with db.read() as session:
        return int(session.scalar(select(func.count()).select_from(table)) or 0)


def test_no_more_inspections_begin_than_may(db: Database, tmp_path: Path) -> None:
    admission = admission_of(db, tmp_path, max_active=7, max_active_per_owner=5)
    mine = [partial(create, admission, "me")] * (AT_ONCE // 2)
    found = outcomes([*mine, *[partial(create, admission, "you")] * (AT_ONCE // 2)])
    assert found["admitted"] == count(db, Inspection) == 7
    assert set(found) <= {"admitted", "too_many_active", "too_many_active_of_owner"}
    with db.read() as session:
        owners = Counter(session.scalars(select(Inspection.owner)))
    assert max(owners.values()) <= 5
    assert count(db, Reservation) == 0, "a place that is used or refused is held no longer"
    with pytest.raises(LimitReached, match="max_active is 7"):
        admission.look("somebody")


def test_an_owner_at_the_limit_does_not_shut_out_others(db: Database, tmp_path: Path) -> None:
    admission = admission_of(db, tmp_path, max_active=10, max_active_per_owner=1)
    create(admission, "me")
    with pytest.raises(LimitReached, match="max_active_per_owner is 1") as caught:
        create(admission, "me")
    assert (caught.value.code, caught.value.where) == ("too_many_active_of_owner", "max_active_per_owner")
    create(admission, "you")


def test_a_place_that_is_held_counts_until_its_time(db: Database, tmp_path: Path) -> None:
    admission = admission_of(db, tmp_path, max_active=1)
    with admission.place("me") as place:
        with pytest.raises(LimitReached):
            create(admission, "you")
        with db.write() as session:  # the process that held it was stopped for an hour
            session.execute(update(Reservation).values(expires_at=db.now(session) - timedelta(seconds=1)))
        create(admission, "you")
        with pytest.raises(LimitReached), db.write() as session:
            place.use(session)
        Retention(db).tidy()
        assert count(db, Reservation) == 0


def test_no_more_bytes_are_promised_than_the_disk_has(
    db: Database, tmp_path: Path, free: Callable[[int], None]
) -> None:
    free(70 * GIB)
    admission = admission_of(db, tmp_path, reserve_bytes=5 * GIB)
    uploads = Uploads(db, tmp_path / "uploads")

    def begin() -> None:
        uploads.create("me", 20 * GIB, {}, partial(admission.admit_upload, owner="me", size=20 * GIB))

    assert outcomes([begin] * AT_ONCE) == {"admitted": 3, "disk_full": AT_ONCE - 3}
    assert count(db, Upload) == len(list((tmp_path / "uploads").iterdir())) == 3, "what is refused leaves nothing"


def test_only_what_is_still_to_come_is_promised(db: Database, tmp_path: Path, free: Callable[[int], None]) -> None:
    free(70 * GIB)
    admission, uploads = admission_of(db, tmp_path), Uploads(db, tmp_path / "uploads")
    first = uploads.create("", 60 * GIB, {})
    begin = partial(uploads.create, "", 20 * GIB, {}, partial(admission.admit_upload, owner="", size=20 * GIB))
    with pytest.raises(DiskFull, match="reserve_bytes"):
        begin()
    uploads.commit(first.id, 50 * GIB)
    free(30 * GIB - 1)
    with pytest.raises(DiskFull):
        begin()
    free(30 * GIB)
    begin()


@pytest.mark.parametrize("ended", ["removed", "expired", "finished"])
def test_an_upload_that_ended_promises_nothing(
    db: Database, tmp_path: Path, free: Callable[[int], None], ended: str
) -> None:
    free(10 * GIB)
    admission, uploads = admission_of(db, tmp_path, max_open_uploads=1), Uploads(db, tmp_path / "uploads")
    begin = partial(uploads.create, "", 8 * GIB, {}, partial(admission.admit_upload, owner="", size=8 * GIB))
    made = begin()
    with pytest.raises(LimitReached, match="max_open_uploads is 1"):
        begin()
    if ended == "removed":
        uploads.remove(made.id)
    elif ended == "finished":
        uploads.commit(made.id, made.length)
    else:
        with db.write() as session:
            session.execute(update(Upload).values(expires_at=db.now(session) - timedelta(seconds=1)))
    begin()


def test_the_row_of_a_removed_upload_ends(db: Database, tmp_path: Path) -> None:
    uploads = Uploads(db, tmp_path / "uploads")
    old, new = (uploads.create("", 5, {}) for _ in range(2))
    for upload, days in ((old, 4), (new, 2)):
        uploads.remove(upload.id)
        with db.write() as session:
            moment = db.now(session) - timedelta(days=days)
            session.execute(update(Upload).where(Upload.id == upload.id).values(removed_at=moment))
    Retention(db).tidy()
    assert uploads.find(old.id, "") is None
    assert uploads.find(new.id, "").removed  # type: ignore[union-attr]


def test_a_form_is_an_open_upload_until_its_end(db: Database, tmp_path: Path, free: Callable[[int], None]) -> None:
    free(10 * GIB)
    admission = admission_of(db, tmp_path, max_open_uploads_per_owner=1)
    form = admission.promise_form("me", 8 * GIB)
    with pytest.raises(LimitReached, match="max_open_uploads_per_owner is 1") as caught:
        admission.promise_form("me", 1)
    assert caught.value.code == "too_many_uploads_of_owner"
    with pytest.raises(DiskFull):
        admission.promise_form("you", 3 * GIB)
    form.keep(6 * GIB)
    admission.promise_form("you", 3 * GIB).end()
    with pytest.raises(DiskFull):
        form.keep(11 * GIB)
    form.end()
    admission.promise_form("me", 10 * GIB)


def test_the_promise_of_a_killed_process_ends_by_itself(
    db: Database, tmp_path: Path, free: Callable[[int], None]
) -> None:
    free(10 * GIB)
    admission = admission_of(db, tmp_path, max_open_uploads=1)
    form = admission.promise_form("me", 8 * GIB)
    with db.write() as session:
        session.execute(update(Reservation).values(expires_at=db.now(session) - timedelta(seconds=1)))
    admission.promise_form("you", 8 * GIB).end()
    Retention(db).tidy()
    assert count(db, Reservation) == 0
    form.keep(7 * GIB)
    with pytest.raises(LimitReached):
        admission.promise_form("you", 1)
