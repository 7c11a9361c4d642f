"""Webhooks are sent at least once and in order for each inspection, whoever is away, and only where they may go."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from datetime import datetime, timedelta
from ipaddress import ip_network
from itertools import groupby
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy.orm import Session
from standardwebhooks import Webhook as StockWebhook

from api.services import make_services
from core.errors import BadInput
from store.db import Database
from store.deliveries import BACK_OFF_S, Deliveries, DeliveryView, Outcome
from store.events import Events, EventType
from store.factory import open_artifacts, open_database
from store.housekeeping import Retention
from store.integration_models import DeliveryState
from store.outbound import Outbound
from store.settings import DeploymentSettings
from store.webhooks import Webhooks
from tests.api.conftest import Backend, wait_until
from tests.databases import BOTH, database_url
from tests.receiver import Receiver, receiver
from tests.store.small_plan import GRAPH
from worker.loop import WorkerService
from worker.webhooks import WebhookSender

pytestmark = pytest.mark.slow

HERE = Outbound([ip_network("127.0.0.1/32")])
OWNER = "default"


@dataclass
class Clock:
    """The database's time, moved on by a test."""

    db: Database
    ahead: timedelta = field(default_factory=timedelta)

    def __call__(self, session: Session) -> datetime:
        return self.db.now(session) + self.ahead

    def advance(self, **more: float) -> None:
        self.ahead += timedelta(**more)


@dataclass
class Place:
    """A service whose events are sent to one receiver."""

    backend: Backend
    receiver: Receiver
    clock: Clock = field(init=False)
    webhooks: Webhooks = field(init=False)

    def __post_init__(self) -> None:
        self.clock = Clock(self.backend.db)
        self.webhooks = Webhooks(self.backend.db, self.clock)
        view, self.secret = self.webhooks.create(OWNER, self.receiver.url)
        self.id = view.id

    @property
    def deliveries(self) -> Deliveries:
        return Deliveries(self.webhooks)

    def sender(self, outbound: Outbound = HERE, seconds: float = 10.0) -> WebhookSender:
        return WebhookSender(self.deliveries, outbound, seconds)

    def live(self, *names: str) -> None:
        """Inspections from their beginning to their end."""
        made = [self.backend.create(name) for name in names]
        for one in made:
            self.backend.work(one)
        for one in made:
            self.backend.finish(one)

    def events(self) -> list[Any]:
        return list(Events(self.backend.db).after(OWNER, 0, 1000))

    def listed(self, state: DeliveryState | None = None) -> Sequence[DeliveryView]:
        return self.deliveries.page(self.id, OWNER, state, 1000).deliveries


@pytest.fixture(params=BOTH)
def backend(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Backend]:
    """A service on either database."""
    with database_url(request.param, tmp_path) as url:
        settings = DeploymentSettings(
            data_dir=tmp_path,
            database_url=url.render_as_string(hide_password=False),
            reserve_bytes=0,
            sweep_s=0.2,
            outbound_networks="127.0.0.1/32",
        )
        db = open_database(settings)
        yield Backend(make_services(settings, db, open_artifacts(settings), wake=lambda _: None, graph=GRAPH))
        db.close()


@pytest.fixture
def place(backend: Backend, tmp_path: Path) -> Iterator[Place]:
    with receiver(tmp_path) as made:
        yield Place(backend, made)


def test_a_receiver_that_is_killed_and_away_for_an_hour_misses_nothing(place: Place) -> None:
    place.live("first")
    dying = place.events()[2]
    place.receiver.start(**{f'"number":{dying.number},': "dies"})
    place.sender().round()
    assert place.receiver.died(), "between the message and its answer"
    assert len(place.receiver.messages()) == 3
    for turn in range(30):
        if turn % 10 == 0:
            place.live(f"{turn} a", f"{turn} b", f"{turn} c")
        place.clock.advance(minutes=2)
        place.sender().round()
    assert len(place.receiver.messages()) == 3
    tried = sum(one.attempts for one in place.listed())
    assert 5 <= tried <= 15, "not again and again to who is not there"
    place.receiver.start()
    for _ in range(31):
        place.clock.advance(minutes=2)
        place.sender().round()
    assert {one.state for one in place.listed()} == {DeliveryState.DELIVERED}
    _require_all_in_order(place)
    numbers = [content["data"]["number"] for _, content in place.receiver.verified(place.secret)]
    assert numbers.count(dying.number) == 2, "at least once: the one whose answer was lost comes again"
    ids = {one["headers"]["webhook-id"] for one in place.receiver.messages()}
    assert len(ids) == len(numbers) - 1, "under the same id"


def _require_all_in_order(place: Place) -> None:
    """Every event came with its content, and those of one inspection in their order."""
    came: dict[str, dict[str, Any]] = {}
    for message_id, content in place.receiver.verified(place.secret):
        came.setdefault(message_id, content)
    events = place.events()
    assert len(came) == len(events) > 40
    by_number = {content["data"]["number"]: content for content in came.values()}
    for event in events:
        content = by_number[event.number]
        assert (content["type"], content["data"]["inspection"]) == (event.type, event.inspection)
        assert datetime.fromisoformat(content["timestamp"]) == event.at
    sent = sorted(came.values(), key=lambda content: str(content["data"]["inspection"]["id"]))  # stable
    for _, group in groupby(sent, key=lambda content: content["data"]["inspection"]["id"]):
        numbers = [content["data"]["number"] for content in group]
        assert numbers == sorted(numbers)


def test_a_sender_that_dies_is_followed_by_another_after_its_lease(place: Place) -> None:
    place.receiver.start()
    place.live("one")
    died = place.deliveries.begin_turn()
    assert died is not None
    message = place.deliveries.next(died)
    assert message is not None
    place.sender().round()
    assert place.receiver.messages() == [], "one sender at a time"
    place.clock.advance(seconds=61)
    place.sender().round()
    assert len(place.receiver.verified(place.secret)) == len(place.events())
    assert place.deliveries.next(died) is None
    assert not place.deliveries.note(died, message, Outcome(500)), "its lease is over, and so is its say"
    assert {one.state for one in place.listed()} == {DeliveryState.DELIVERED}


def test_senders_side_by_side_send_nothing_twice(place: Place) -> None:
    place.receiver.start()
    threads = [threading.Thread(target=place.sender().round) for _ in range(4)]
    place.live(*(str(number) for number in range(5)))
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(60)
    numbers = [content["data"]["number"] for _, content in place.receiver.verified(place.secret)]
    assert sorted(numbers) == [event.number for event in place.events()]


def test_an_event_that_is_refused_holds_up_its_inspection_only_and_for_a_day(place: Place) -> None:
    place.live("bad", "good")
    bad = place.events()[0].inspection["id"]
    place.receiver.start(**{bad: "500"})
    sender = place.sender()
    sender.round()
    came = [content["data"]["inspection"]["id"] for _, content in place.receiver.verified(place.secret)]
    others = [event for event in place.events() if event.inspection["id"] != bad]
    assert (came.count(bad), len(came)) == (1, 1 + len(others))
    failed = place.listed(DeliveryState.PENDING)[-1]
    assert (failed.status, failed.attempts, failed.error) == (500, 1, "it answered 500")
    for seconds in BACK_OFF_S[:3]:
        before = len(place.receiver.messages())
        sender.round()
        assert len(place.receiver.messages()) == before, "not before its time"
        place.clock.advance(seconds=seconds + 0.5)
        sender.round()
        assert len(place.receiver.messages()) == before + 1
    place.clock.advance(hours=24)
    place.receiver.stop()
    place.receiver.start(**{f'"id":"{bad}","state":"queued"': "500"})
    sender.round()
    first, *later = [one for one in reversed(place.listed()) if one.inspection_id == bad]
    assert (first.state, first.next_at) == (DeliveryState.FAILED, None)
    assert {one.state for one in later} == {DeliveryState.DELIVERED}
    place.receiver.stop()
    place.receiver.start()
    place.deliveries.again(place.id, first.id, OWNER)
    sender.round()
    again = place.receiver.verified(place.secret)[-1]
    assert (again[0], again[1]["data"]["number"]) == (f"msg_{first.id}", first.number)
    assert not place.listed(DeliveryState.FAILED)


def test_a_secret_that_is_replaced_is_good_for_a_while(place: Place) -> None:
    place.receiver.start()
    sender, old = place.sender(), place.secret

    def last(secret: str) -> Any:
        place.deliveries.test(place.id)
        sender.round()
        one = place.receiver.messages()[-1]
        return StockWebhook(secret).verify(one["body"], one["headers"])

    assert last(old)["type"] == "webhook.test"
    _, new = place.webhooks.rotate(place.id, timedelta(hours=2))
    assert last(old)["type"] == last(new)["type"] == "webhook.test"
    assert len(place.receiver.messages()[-1]["headers"]["webhook-signature"].split()) == 2
    with pytest.raises(BadInput, match="an older secret is valid"):
        place.webhooks.rotate(place.id, timedelta(hours=2))
    place.clock.advance(hours=3)
    assert last(new)["type"] == "webhook.test"
    with pytest.raises(Exception, match="No matching signature"):
        last(old)
    _, newest = place.webhooks.rotate(place.id, timedelta(hours=2))
    _, newest = place.webhooks.rotate(place.id, timedelta(0))
    assert last(newest)["type"] == "webhook.test"
    with pytest.raises(Exception, match="No matching signature"):
        last(new)


def test_who_is_gone_gets_nothing_more(place: Place) -> None:
    place.live("one")
    place.receiver.start(queued="410")
    place.sender().round()
    assert len(place.receiver.messages()) == 1
    assert place.webhooks.get(place.id).disabled_at is not None
    assert {one.state for one in place.listed()} == {DeliveryState.FAILED}
    place.live("two")
    place.sender().round()
    assert len(place.receiver.messages()) == 1


def test_only_types_that_are_wanted_and_events_from_now_on_are_sent(place: Place) -> None:
    place.receiver.start()
    place.live("before")
    some, secret = place.webhooks.create(OWNER, place.receiver.url, "", [EventType.SUCCEEDED, EventType.FAILED])
    place.webhooks.delete(place.id)
    place.live("after")
    place.sender().round()
    [(_, content)] = place.receiver.verified(secret)
    assert content["type"] == "inspection.succeeded"
    assert content["data"]["inspection"]["id"] == place.events()[-1].inspection["id"]
    assert place.deliveries.begin_turn() is None, "nothing is left to look at"
    place.deliveries.test(some.id)
    Retention(place.backend.db, event_days=0.0).tidy()
    assert place.deliveries.page(some.id, OWNER, None, 10).deliveries == [], "they go with their events"
    place.sender().round()


def test_where_a_name_leads_is_asked_again_at_every_delivery(place: Place) -> None:
    """A name whose address becomes a private one between two look-ups."""
    place.receiver.start()
    said: list[str] = []

    def look_up(host: str, port: int) -> list[str]:
        said.append(host)
        return ["127.0.0.1"] if len(said) == 1 else ["127.0.0.1", "127.0.0.2"]

    url = place.receiver.url.replace("127.0.0.1", "hooks.test")
    place.webhooks.delete(place.id)
    view, secret = place.webhooks.create(OWNER, url)
    place.id = view.id
    sender = place.sender(Outbound(HERE.networks, look_up))
    place.deliveries.test(place.id)
    sender.round()
    assert len(place.receiver.verified(secret)) == 1, "to the address that was checked"
    assert place.receiver.messages()[0]["headers"]["Host"] == f"hooks.test:{place.receiver.port}"
    place.deliveries.test(place.id)
    sender.round()
    assert said == ["hooks.test", "hooks.test"]
    [refused] = place.listed(DeliveryState.PENDING)
    assert "not public" in refused.error
    assert "127.0.0.2" not in refused.error, "what is where inside is told to nobody"
    assert len(place.receiver.messages()) == 1


def test_an_answer_that_drips_in_takes_no_longer_than_it_may(place: Place) -> None:
    place.live("one")
    place.receiver.start(queued="drips")
    begin = time.monotonic()
    place.sender(seconds=1.0).round()
    assert time.monotonic() - begin < 4
    first = place.listed(DeliveryState.PENDING)[-1]
    assert (first.status, first.attempts) == (None, 1)
    assert "ReadTimeout" in first.error


def test_a_worker_sends_by_itself(place: Place) -> None:
    place.receiver.start()
    services = place.backend.services
    service = WorkerService(services.settings, services.db, services.artifacts, GRAPH, "worker")
    service.start()
    try:
        place.backend.create("one")
        wait_until(lambda: len(place.receiver.messages()) == 1)
    finally:
        service.stop()
    assert place.receiver.verified(place.secret)[0][1]["type"] == "inspection.queued"
