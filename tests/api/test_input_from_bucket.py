"""Inputs from buckets of an S3 server: what is fetched with the store's own client, and what is refused."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from typing import Any

import fsspec
import httpx
import pytest
from fastapi import FastAPI
from pydantic import SecretStr

from api.app import create_app
from core.errors import BadInput
from store.bucket_inputs import AllowedBuckets, BucketInputs
from store.downloads import Begun
from store.environment import deployment_settings
from store.leasing import input_files
from store.models import Inspection
from store.settings import PREFIX
from tests.api.conftest import Backend
from tests.store.object_store import new_bucket, options

VIDEO = bytes(range(256)) * 40_000
"""More than one request fetches."""


class Place:
    """A server that may fetch from `incoming`, and from one part of `archive`."""

    def __init__(self, backend: Backend, address: str, serve: Callable[[FastAPI], str], **more: Any) -> None:
        self.files = fsspec.filesystem("s3", **options(address))
        self.incoming, self.archive = (new_bucket(address).removeprefix("s3://") for _ in range(2))
        self.put(f"{self.incoming}/day 1/vidéo.mp4", VIDEO)
        self.put(f"{self.incoming}/notes.json", b"[]")
        self.put(f"{self.archive}/borescope/one.mp4", b"one")
        self.put(f"{self.archive}/borescope-private/two.mp4", b"two")
        secret = {"artifacts_key": SecretStr("test"), "artifacts_secret": SecretStr("test")}
        names = {"input_buckets": f"{self.incoming}, {self.archive}/borescope"}
        self.backend = backend.with_settings(**{"artifacts_endpoint": address, **secret, **names, **more})
        self.app = create_app(self.backend.services)
        self.url = serve(self.app)

    def put(self, path: str, data: bytes) -> None:
        self.files.pipe_file(path, data)

    def post(self, **body: Any) -> httpx.Response:
        return httpx.post(f"{self.url}/v1/inspections", json=body, timeout=60)

    def refused(self, url: str, **more: Any) -> tuple[int, str, str]:
        answer = self.post(video_url=url, **more)
        body = answer.json()
        return answer.status_code, body["code"], body["detail"]


@pytest.fixture
def place(backend: Backend, s3: str, serve: Callable[[FastAPI], str], unprobed: None) -> Place:
    return Place(backend, s3, serve, max_upload_bytes=len(VIDEO))


def test_a_video_and_its_annotations_come_from_a_bucket(place: Place) -> None:
    sha256 = hashlib.sha256(VIDEO).hexdigest()
    answer = place.post(
        video_url=f"s3://{place.incoming}/day 1/vidéo.mp4",
        video_sha256=sha256,
        annotations_url=f"s3://{place.incoming}/notes.json",
    )
    assert answer.status_code == 202, answer.text
    with place.backend.db.read() as session:
        (files,) = input_files(session.get_one(Inspection, answer.json()["id"]))
    assert files.video_sha256 == sha256
    assert place.backend.services.artifacts.exists(files.annotations or "")
    assert place.post(video_url=f"s3://{place.archive}/borescope/one.mp4").status_code == 202


def test_what_is_not_fetched(place: Place) -> None:
    incoming, archive = place.incoming, place.archive
    code = {
        f"s3://{archive}/borescope-private/two.mp4": "bucket_not_allowed",
        f"s3://{archive}/borescope/../borescope-private/two.mp4": "bad_url",
        f"s3://{incoming}x/notes.json": "bucket_not_allowed",
        f"s3://{incoming}/": "bad_url",
        f"s3://{incoming}": "bad_url",
        f"s3://{incoming}//notes.json": "bad_url",
        f"S3://{incoming}/notes.json": "bad_url",
        f"s3://{incoming}/missing.mp4": "fetch_refused",
        f"s3://{incoming}/day 1": "fetch_refused",
    }
    assert {url: place.refused(url)[:2] for url in code} == {url: (422, said) for url, said in code.items()}
    wrong = place.post(video_url=f"s3://{incoming}/notes.json", video_sha256="0" * 64)
    assert (wrong.status_code, wrong.json()["code"], wrong.json()["where"]) == (422, "checksum", "/video_url")
    place.put(f"{incoming}/large.mp4", VIDEO + b"x")
    assert place.refused(f"s3://{incoming}/large.mp4")[:2] == (413, "too_large")
    left = place.backend.services.uploads.page("default", None, 10, None).uploads
    assert [upload for upload in left if not upload.removed] == []


def test_without_buckets_none_is_asked(backend: Backend, address: str) -> None:
    answer = httpx.post(f"{address}/v1/inspections", json={"video_url": "s3://incoming/one.mp4"})
    assert (answer.status_code, answer.json()["code"]) == (422, "bucket_not_allowed")
    assert "input_buckets is empty" in answer.json()["detail"]


class Kept:
    """Takes bytes, and does something after the first."""

    def __init__(self, then: Callable[[], None]) -> None:
        self.data, self.tag, self._then = b"", "", then

    @property
    def offset(self) -> int:
        return len(self.data)

    def write(self, data: bytes) -> None:
        self.data += data
        self._then()

    def restart(self, tag: str) -> None:
        self.data, self.tag = b"", tag


def test_a_file_that_changes_and_one_that_takes_too_long(s3: str) -> None:
    bucket = new_bucket(s3).removeprefix("s3://")
    files = fsspec.filesystem("s3", **options(s3))
    files.pipe_file(f"{bucket}/a.mp4", VIDEO)
    source = BucketInputs(AllowedBuckets.parse(bucket), options(s3), sleep=lambda _: None)
    sink = Kept(lambda: files.pipe_file(f"{bucket}/a.mp4", VIDEO[::-1]))
    with pytest.raises(BadInput) as changed:
        source.fetch(f"s3://{bucket}/a.mp4", 1 << 30, 60, lambda *_: sink)
    assert changed.value.code == "fetch_changed"
    with pytest.raises(BadInput) as late:
        source.fetch(f"s3://{bucket}/a.mp4", 1 << 30, 0, lambda *_: sink)
    assert late.value.code == "fetch_timeout"


def test_the_rest_of_a_file_is_fetched_unless_it_is_another_by_now(s3: str) -> None:
    bucket = new_bucket(s3).removeprefix("s3://")
    files = fsspec.filesystem("s3", **options(s3))
    files.pipe_file(f"{bucket}/a.mp4", VIDEO)
    source = BucketInputs(AllowedBuckets.parse(bucket), options(s3), sleep=lambda _: None)
    tag = files.info(f"{bucket}/a.mp4", refresh=True)["ETag"]
    for first, told, came in ((b"x" * 10, tag, b"x" * 10 + VIDEO[10:]), (b"x" * 10, "", VIDEO), (b"", "", VIDEO)):
        sink = Kept(lambda: None)
        sink.data = first
        source.fetch(f"s3://{bucket}/a.mp4", 1 << 30, 60, _never, Begun(sink, len(VIDEO), told))
        assert sink.data == came
        assert sink.tag == ("" if told else tag)
    with pytest.raises(BadInput) as other:
        source.fetch(f"s3://{bucket}/a.mp4", 1 << 30, 60, _never, Begun(sink, len(VIDEO) - 1, tag))
    assert other.value.code == "fetch_changed"


def _never(size: int, tag: str) -> Kept:
    raise AssertionError("it was begun before")


@pytest.mark.parametrize(
    ("buckets", "store", "good"),
    [
        ("incoming,archive/borescope/", "", True),
        ("incoming", "s3://bladeatlas/store", True),
        ("data/incoming", "s3://data/store", True),
        ("data", "s3://data/store", False),
        ("data/store/inputs", "s3://data/store", False),
        ("Incoming", "", False),
        ("s3://incoming", "", False),
        ("incoming/../other", "", False),
    ],
)
def test_buckets_of_the_setting(monkeypatch: pytest.MonkeyPatch, buckets: str, store: str, good: bool) -> None:
    monkeypatch.setenv(f"{PREFIX}INPUT_BUCKETS", buckets)
    monkeypatch.setenv(f"{PREFIX}ARTIFACTS_URL", store)
    if good:
        assert deployment_settings().input_buckets == buckets
    else:
        with pytest.raises(BadInput, match="INPUT_BUCKETS: must"):
            deployment_settings()
