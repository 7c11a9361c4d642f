"""API keys and idempotency keys, on SQLite and PostgreSQL."""

from __future__ import annotations

import pytest
from sqlalchemy import select
from sqlalchemy.exc import IntegrityError

from core.errors import BadInput
from store.account_models import ApiKey
from store.admission import IdempotencyKeys, OtherBody
from store.db import Database
from store.keys import KeyRing, Keys, utc_now


class Clock:
    """Time as the test says it is."""

    now = 0.0

    def __call__(self) -> float:
        return self.now


def test_a_key_is_kept_as_a_hash_and_found_again(db: Database) -> None:
    keys = Keys(db)
    view, key = keys.create("inspector")
    with db.read() as session:
        (row,) = session.scalars(select(ApiKey)).all()
    assert key not in str(vars(row))
    assert key.split("_", 2)[2] not in str(vars(row))
    ring = KeyRing(keys)
    ring.refresh()
    assert ring.find(key) == view
    for wrong in ("", key[:-1], key + "x", key.replace("ba_", "ab_"), f"ba_{'0' * 32}_{'A' * 43}", "ü", "\ud800"):
        assert ring.find(wrong) is None
    other = keys.create("other")[1]
    mixed = f"ba_{view.id}_{other.split('_', 2)[2]}"
    assert ring.find(mixed) is None


def ever_made(ring: KeyRing) -> bool:
    """Asked anew: the type checker takes a property for a value that stays."""
    return ring.ever_made


def fresh(ring: KeyRing) -> bool:
    """Asked anew, as `ever_made`."""
    return ring.fresh


def test_only_where_no_key_was_ever_made_there_is_none(db: Database) -> None:
    keys = Keys(db)
    ring = KeyRing(keys)
    assert ever_made(ring), "until it was looked, nobody is let in without a key"
    ring.refresh()
    assert not ever_made(ring)
    keys.revoke(keys.create("inspector")[0].id)
    restarted = Database(db.engine.url)
    again = KeyRing(Keys(restarted))
    again.refresh()
    restarted.close()
    assert again.ever_made


def test_a_revoked_key_ends_within_a_moment(db: Database) -> None:
    keys, clock = Keys(db), Clock()
    view, key = keys.create("inspector")
    ring = KeyRing(keys, clock=clock)
    ring.refresh()
    assert ever_made(ring)
    keys.revoke(view.id)
    assert fresh(ring)
    clock.now = 1.1
    assert not fresh(ring)
    ring.refresh()
    found = ring.find(key)
    assert found is not None
    assert found.ended(utc_now()) == "was revoked"
    assert ever_made(ring), "a revoked key is still one that was made"
    assert [found.revoked_at is not None for found in keys.all()] == [True]
    with pytest.raises(BadInput):
        keys.revoke("nobody")


def test_the_use_of_a_key_is_noted_once_a_minute(db: Database) -> None:
    keys, clock = Keys(db), Clock()
    view, _ = keys.create("inspector")
    ring = KeyRing(keys, clock=clock)
    assert [ring.unnoted(view.id), ring.unnoted(view.id)] == [True, False]
    clock.now = 61.0
    assert ring.unnoted(view.id)
    keys.note_use(view.id)
    first = keys.all()[0].last_used_at
    assert first is not None
    keys.note_use(view.id)
    assert keys.all()[0].last_used_at == first


def test_a_request_is_known_by_its_key_and_its_body(db: Database) -> None:
    keys = IdempotencyKeys(db)
    assert keys.find("me", "k", "a" * 64) is None
    with db.write() as session:
        keys.add(session, "me", "k", "a" * 64, "one")
    assert keys.find("me", "k", "a" * 64) == "one"
    assert keys.find("you", "k", "a" * 64) is None
    with pytest.raises(OtherBody):
        keys.find("me", "k", "b" * 64)
    with pytest.raises(IntegrityError), db.write() as session:
        keys.add(session, "me", "k", "a" * 64, "two")
    assert keys.find("me", "k", "a" * 64) == "one"
