"""Who is let in: this machine while there is no key, then only those who have one."""

from __future__ import annotations

import pytest

from store.keys import Keys
from tests.api.conftest import TUS, Backend, client_of

PATHS = ("/v1/inspections", "/v1/options", "/v1/system", "/v1/limits", "/metrics")


@pytest.mark.parametrize("host", ["127.0.0.1", "127.8.9.1", "::1", "localhost"])
def test_without_keys_this_machine_is_served(backend: Backend, host: str) -> None:
    client = client_of(backend, host)
    assert {path: client.get(path).status_code for path in PATHS} == dict.fromkeys(PATHS, 200)


@pytest.mark.parametrize("host", ["10.0.0.7", "192.168.1.2", "2001:db8::1", "example.org"])
def test_without_keys_others_are_not(backend: Backend, host: str) -> None:
    client = client_of(backend, host)
    for path in PATHS:
        answer = client.get(path)
        assert (answer.status_code, answer.json()["code"]) == (401, "unauthorized")
        assert answer.headers["WWW-Authenticate"] == "Bearer"
    assert client.post("/v1/uploads", headers={**TUS, "Upload-Length": "1"}).status_code == 401
    assert client.get("/healthz").status_code == 200


def test_with_keys_everybody_needs_one(backend: Backend) -> None:
    view, key = Keys(backend.db).create("inspector")
    client = client_of(backend)
    assert client.get("/v1/inspections").status_code == 401
    good = {"Authorization": f"Bearer {key}"}
    assert client.get("/v1/inspections", headers=good).status_code == 200
    assert Keys(backend.db).all()[0].last_used_at is not None
    for wrong in ("Bearer x", f"Bearer {key}x", f"Basic {key}", f"Bearer {view.id}", "Bearer", f"bearer  {key}y"):
        answer = client.get("/v1/inspections", headers={"Authorization": wrong})
        assert answer.status_code == 401, wrong
        assert key not in answer.text
    assert client.get(f"/v1/inspections?key={key}").status_code == 401, "never in a query"
    Keys(backend.db).revoke(view.id)
    for client in (client_of(backend), client_of(backend, "::1")):
        for headers in ({}, good):
            answers = {path: client.get(path, headers=headers).status_code for path in PATHS}
            assert answers == dict.fromkeys(PATHS, 401), "the last key is revoked: nobody is let in"


def test_an_upload_of_another_account_is_not_found(backend: Backend) -> None:
    mine, other = ({**backend.key(account), **TUS} for account in ("mine", "other"))
    client = client_of(backend)
    url = client.post("/v1/uploads", headers={**mine, "Upload-Length": "3"}).headers["Location"]
    body = {"Content-Type": "application/offset+octet-stream", "Upload-Offset": "0"}
    assert client.patch(url, content=b"abc", headers={**mine, **body}).status_code == 204
    assert client.head(url, headers=other).status_code == 404
    assert client.delete(url, headers=other).status_code == 404
    refused = client.post("/v1/inspections", json={"video_upload": url.rsplit("/", 1)[1]}, headers=other)
    assert (refused.status_code, refused.json()["errors"][0]["detail"]) == (422, "there is no such upload")
