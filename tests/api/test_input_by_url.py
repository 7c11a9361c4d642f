"""Inputs by URL from a local https server with an authority of its own: what is fetched, and what is refused."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from datetime import timedelta
from typing import Any

import httpx
import pytest
from fastapi import FastAPI
from sqlalchemy import select

from store.downloads import AllowedHosts
from store.integration_models import Transfer
from tests.api.conftest import Backend
from tests.api.fetching import Place, kept, make_place, refused, uploads_left
from tests.api.file_server import DATA, HERE, Files

pytestmark = pytest.mark.slow


@pytest.fixture
def place(backend: Backend, files: Files, serve: Callable[[FastAPI], str], unprobed: None) -> Place:
    return make_place(backend, files, serve)


def let_pass(place: Place, seconds: float) -> None:
    """Requests were sent so much longer ago."""
    with place.backend.db.write() as session:
        for row in session.scalars(select(Transfer)):
            row.asked_at -= timedelta(seconds=seconds)


def test_videos_and_annotations_are_fetched(place: Place, files: Files) -> None:
    digest = hashlib.sha256(DATA).hexdigest()
    answer = place.post_until(video_url=files.url(), video_sha256=digest, annotations_url=files.url("/notes"))
    assert answer.status_code == 202, answer.text
    assert kept(place, answer) == [DATA, b"[]"]
    assert uploads_left(place) == 0, "the inspection has its own"
    files.content["/second"] = DATA[:1000]
    videos = [{"video_url": files.url()}, {"video_url": files.url("/second"), "annotations": []}]
    assert kept(place, place.post_until(videos=videos)) == [DATA, DATA[:1000], b"[]"]


def test_a_transfer_that_is_cut_goes_on_where_it_was(place: Place, files: Files) -> None:
    files.cut_after = [1_100_000, 0, 700_000]
    assert kept(place, place.post_until(video_url=files.url())) == [DATA]
    ranges = [wanted for _, wanted in files.asked]
    assert len(ranges) == 4
    assert ranges[0] == ""
    offsets = [int(wanted[6:-1]) for wanted in ranges[1:]]
    assert offsets == sorted(offsets)
    assert 0 < offsets[0] <= 1_100_000
    assert offsets[-1] > offsets[0]


def test_without_a_tag_it_begins_anew(place: Place, files: Files) -> None:
    files.tag, files.cut_after = "", [1_500_000]
    assert kept(place, place.post_until(video_url=files.url())) == [DATA]
    assert [wanted for _, wanted in files.asked] == ["", ""]


def test_a_redirect_is_followed_to_where_it_may_go(place: Place, files: Files) -> None:
    files.redirects = {"/moved": "/again", "/again": files.url()}
    assert kept(place, place.post_until(video_url=files.url("/moved"))) == [DATA]
    assert len(place.looked_up) == 3, "each is looked up and checked"


def test_who_asks_again_takes_up_the_same_transfer(place: Place, files: Files) -> None:
    place.app.state.bladeatlas.fetches.wait_s = 0.2
    files.piece_s = 0.03
    first = place.post(video_url=files.url())
    assert (first.status_code, first.json()["code"]) == (409, "fetching")
    assert place.post_until(video_url=files.url()).status_code == 202
    assert len(files.asked) == 1


def test_what_nobody_took_up_soon_is_fetched_anew(place: Place, files: Files) -> None:
    wrong = {"video_url": files.url(), "parameters": {"options": {"no.such": 1}}}
    for later, requests in ((0.0, 1), (100.0, 1), (1000.0, 2)):
        let_pass(place, later)
        assert place.post_until(**wrong).json()["code"] == "bad_parameters"
        assert len(files.asked) == requests
        assert uploads_left(place) == 1
    files.content["/video"] = DATA[:5]
    let_pass(place, 1000.0)
    assert kept(place, place.post_until(video_url=files.url())) == [DATA[:5]]
    assert uploads_left(place) == 0


@pytest.mark.parametrize(
    ("host", "code"),
    [
        ("elsewhere.test", "host_not_allowed"),
        ("inside.test", "private_address"),
        ("files.test.", "unreachable"),  # the same name to the list, but no name of the certificate
    ],
)
def test_hosts_that_are_refused(place: Place, files: Files, host: str, code: str) -> None:
    place.leads_to = lambda name, times: ["127.0.0.1"] if name == "inside.test" else [HERE]
    assert refused(place.post(video_url=files.url(host=host))) == (422, code, "/video_url")
    assert files.asked == []
    assert uploads_left(place) == 0


@pytest.mark.parametrize(
    ("target", "code"),
    [
        ("https://elsewhere.test/video", "host_not_allowed"),
        ("http://files.test/video", "insecure_url"),
        ("/moved", "fetch_refused"),
        ("https://inside.test:PORT/video", "private_address"),
        ("file:///etc/passwd", "bad_url"),
    ],
)
def test_redirects_that_are_refused(place: Place, files: Files, target: str, code: str) -> None:
    files.redirects = {"/moved": target.replace("PORT", str(files.port))}
    answer = place.post(video_upload="0" * 32, annotations_url=files.url("/moved"))
    assert refused(answer) == (422, code, "/annotations_url")
    assert {path for path, _ in files.asked} == {"/moved"}


def test_a_name_that_leads_elsewhere_at_the_second_look_up_is_refused(place: Place, files: Files) -> None:
    files.cut_after = [1_100_000]
    place.leads_to = lambda name, times: [HERE] if times == 1 else [HERE, "127.0.0.1"]
    assert refused(place.post(video_url=files.url())) == (422, "private_address", "/video_url")
    assert len(files.asked) == 1
    assert uploads_left(place) == 0


def test_sizes_times_and_answers_that_are_refused(
    backend: Backend, files: Files, serve: Callable[[FastAPI], str], unprobed: None
) -> None:
    settings = {"max_upload_bytes": len(DATA) - 1, "fetch_seconds": 1.0, "max_annotations_bytes": 4}
    place = make_place(backend, files, serve, **settings)
    assert refused(place.post(video_url=files.url())) == (413, "too_large", "/video_url")
    files.content["/video"] = DATA[:-1]
    wrong = place.post(video_url=files.url(), video_sha256="0" * 64)
    assert refused(wrong) == (422, "checksum", "/video_url")
    files.says_length = False
    assert refused(place.post(video_url=files.url())) == (422, "no_length", "/video_url")
    files.says_length, files.status = True, 404
    assert refused(place.post(video_url=files.url())) == (422, "fetch_refused", "/video_url")
    files.status = 503
    away = place.post(video_url=files.url())
    assert refused(away) == (422, "unreachable", "/video_url")
    assert away.json()["retryable"]
    files.status, files.piece_s = 0, 0.2
    assert refused(place.post(video_url=files.url())) == (422, "fetch_timeout", "/video_url")
    assert uploads_left(place) == 0


def test_a_server_that_cuts_for_ever_is_given_up(place: Place, files: Files) -> None:
    files.cut_after = [1_100_000] + [0] * 20
    assert refused(place.post(video_url=files.url())) == (422, "unreachable", "/video_url")
    assert len(files.asked) == 6


def test_a_certificate_of_another_authority_is_refused(
    place: Place, files: Files, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("SSL_CERT_FILE")
    assert refused(place.post(video_url=files.url())) == (422, "unreachable", "/video_url")
    assert files.asked == []


def test_without_a_list_nothing_is_fetched(backend: Backend, address: str) -> None:
    body = {"video_url": "https://files.example.com/video.mp4"}
    answer = httpx.post(f"{address}/v1/inspections", json=body)
    assert refused(answer) == (422, "host_not_allowed", "/video_url")
    assert "input_hosts is empty" in answer.json()["detail"]


def test_transfers_are_bounded_by_owner(
    backend: Backend, files: Files, serve: Callable[[FastAPI], str], unprobed: None
) -> None:
    place = make_place(backend, files, serve, max_fetches_per_owner=1)
    place.app.state.bladeatlas.fetches.wait_s = 0.1
    files.piece_s = 0.05
    assert place.post(video_url=files.url()).status_code == 409
    other = place.post(video_url=files.url("/notes"))
    assert (other.status_code, other.json()["code"]) == (429, "too_many_fetches_of_owner")


@pytest.mark.parametrize(
    ("body", "pointer"),
    [
        ({"video_url": "https://files.test/", "video_upload": "0" * 32}, "/video_url"),
        ({"video_upload": "0" * 32, "annotations": [], "annotations_url": "https://files.test/"}, "/annotations_url"),
        ({"video_upload": "0" * 32, "video_sha256": "0" * 64}, "/video_sha256"),
        ({"annotations_url": "https://files.test/"}, "/video_upload"),
        ({"videos": [{"video_url": "https://files.test/"}], "video_url": "https://files.test/"}, "/videos"),
        ({"videos": [{}]}, "/videos/0/video_upload"),
    ],
)
def test_bodies_that_say_two_things(address: str, body: dict[str, Any], pointer: str) -> None:
    answer = httpx.post(f"{address}/v1/inspections", json=body)
    assert (answer.status_code, answer.json()["errors"][0]["pointer"]) == (422, pointer)


@pytest.mark.parametrize(
    ("entries", "url", "allowed"),
    [
        ("files.test", "https://files.test/x", True),
        ("files.test", "https://FILES.test./x", True),
        ("files.test", "https://files.test:8443/x", False),
        ("files.test:8443", "https://files.test:8443/x", True),
        ("*.files.test", "https://a.b.files.test/x", True),
        ("*.files.test", "https://files.test/x", False),
        ("*.files.test", "https://evilfiles.test/x", False),
        ("files.test", "https://files.test.evil.example/x", False),
    ],
)
def test_a_list_of_hosts_means_what_it_says(entries: str, url: str, allowed: bool) -> None:
    hosts = AllowedHosts.parse(entries)
    if allowed:
        hosts.require(url)
    else:
        with pytest.raises(Exception, match="input_hosts has it not"):
            hosts.require(url)
