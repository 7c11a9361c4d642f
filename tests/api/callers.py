"""A place with one thing of every kind that belongs to an account, and the table of routes with the scope of each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from fastapi.testclient import TestClient

from api.auth import COOKIE
from store.account_models import Scope
from store.deliveries import Deliveries
from store.keys import Keys
from store.webhooks import Webhooks
from tests.api.conftest import TUS, Backend, client_of
from tests.api.test_results import ROWS

ANY = None
"""Any valid key will do."""
_ONE = "/v1/inspections/{inspection_id}"
_HOOK = "/v1/webhooks/{webhook_id}"
ROUTES: dict[tuple[str, str], Scope | None] = {
    ("GET", "/metrics"): Scope.READ,
    ("GET", "/v1/system"): Scope.READ,
    ("GET", "/v1/options"): Scope.READ,
    ("GET", "/v1/schemas/annotations.json"): Scope.READ,
    ("GET", "/v1/presets"): Scope.READ,
    ("GET", "/v1/presets/{name}"): Scope.READ,
    ("GET", "/v1/limits"): Scope.READ,
    ("GET", "/v1/inspections"): Scope.READ,
    ("GET", _ONE): Scope.READ,
    ("GET", f"{_ONE}/stages"): Scope.READ,
    ("GET", f"{_ONE}/events"): Scope.READ,
    ("GET", "/v1/events"): Scope.READ,
    ("GET", f"{_ONE}/logs"): Scope.READ,
    ("GET", f"{_ONE}/cases"): Scope.READ,
    ("GET", f"{_ONE}/cases/{{name}}"): Scope.READ,
    ("GET", f"{_ONE}/metrics"): Scope.READ,
    ("GET", f"{_ONE}/quality"): Scope.READ,
    ("GET", f"{_ONE}/detections"): Scope.READ,
    ("GET", f"{_ONE}/timeline"): Scope.READ,
    ("GET", f"{_ONE}/defects"): Scope.READ,
    ("GET", f"{_ONE}/reviews"): Scope.READ,
    ("GET", f"{_ONE}/reviewed"): Scope.READ,
    ("POST", f"{_ONE}/reviews"): Scope.REVIEW,
    ("POST", f"{_ONE}/reviews/import"): Scope.REVIEW,
    ("GET", f"{_ONE}/artifacts"): Scope.READ,
    ("GET", f"{_ONE}/artifacts/{{path}}"): Scope.READ,
    ("HEAD", f"{_ONE}/artifacts/{{path}}"): Scope.READ,
    ("GET", f"{_ONE}/archive.zip"): Scope.READ,
    ("GET", f"{_ONE}/frames/{{index}}.jpg"): Scope.READ,
    ("GET", f"{_ONE}/report.{{form}}"): Scope.READ,
    ("GET", f"{_ONE}/viewer/{{path}}"): Scope.READ,
    ("HEAD", f"{_ONE}/viewer/{{path}}"): Scope.READ,
    ("GET", f"{_ONE}/models/{{model}}/viewer/{{path}}"): Scope.READ,
    ("HEAD", f"{_ONE}/models/{{model}}/viewer/{{path}}"): Scope.READ,
    ("GET", "/v1/uploads"): Scope.READ,
    ("POST", "/v1/uploads"): Scope.SUBMIT,
    ("HEAD", "/v1/uploads/{upload_id}"): Scope.SUBMIT,
    ("PATCH", "/v1/uploads/{upload_id}"): Scope.SUBMIT,
    ("POST", "/v1/inspections"): Scope.SUBMIT,
    ("PATCH", _ONE): Scope.SUBMIT,
    ("POST", f"{_ONE}/retry"): Scope.SUBMIT,
    ("PATCH", f"{_ONE}/row"): Scope.SUBMIT,
    ("POST", f"{_ONE}/cancel"): Scope.SUBMIT,
    ("POST", f"{_ONE}/links"): Scope.READ,
    ("GET", "/v1/session"): ANY,
    ("POST", "/v1/session"): ANY,
    ("GET", "/v1/keys"): Scope.MANAGE,
    ("POST", "/v1/keys"): Scope.MANAGE,
    ("POST", "/v1/keys/{key_id}/rotate"): Scope.MANAGE,
    ("GET", "/v1/accounts/{account_id}"): Scope.READ,
    ("GET", "/v1/accounts/{account_id}/export.zip"): Scope.MANAGE,
    ("GET", "/v1/accounts"): Scope.ADMIN,
    ("POST", "/v1/accounts"): Scope.ADMIN,
    ("PATCH", "/v1/accounts/{account_id}"): Scope.ADMIN,
    ("GET", "/v1/audit"): Scope.ADMIN,
    ("GET", "/v1/webhooks"): Scope.MANAGE,
    ("POST", "/v1/webhooks"): Scope.MANAGE,
    ("GET", _HOOK): Scope.MANAGE,
    ("POST", f"{_HOOK}/rotate"): Scope.MANAGE,
    ("POST", f"{_HOOK}/test"): Scope.MANAGE,
    ("GET", f"{_HOOK}/deliveries"): Scope.MANAGE,
    ("POST", f"{_HOOK}/deliveries/{{delivery_id}}/redeliver"): Scope.MANAGE,
    # What takes away what the others need comes last.
    ("DELETE", "/v1/uploads/{upload_id}"): Scope.SUBMIT,
    ("DELETE", _ONE): Scope.SUBMIT,
    ("DELETE", _HOOK): Scope.MANAGE,
    ("DELETE", "/v1/keys/{key_id}"): Scope.MANAGE,
    ("DELETE", "/v1/session"): ANY,
    ("DELETE", "/v1/accounts/{account_id}/links"): Scope.MANAGE,
    ("DELETE", "/v1/accounts/{account_id}"): Scope.MANAGE,
}
FREE = {("OPTIONS", "/v1/uploads")}
"""Says what the server can do, to whoever asks."""
HIDDEN = {route for route in ROUTES if route[0] == "HEAD" and route[1].endswith("/{path}")}
"""Not in the description of the API."""
_FILE = "quality.json"
"""Name of a published file, and of one of every page."""
OF_AN_ACCOUNT = ("{inspection_id}", "{upload_id}", "{key_id}", "{account_id}", "{webhook_id}")
BODIES: dict[tuple[str, str], dict[str, Any]] = {
    ("POST", "/v1/inspections"): {"json": {"video_upload": "0" * 32}},
    ("PATCH", _ONE): {"json": {"label": "renamed"}},
    ("PATCH", f"{_ONE}/row"): {"json": {"count": 64}},
    ("POST", f"{_ONE}/reviews"): {
        "json": {"target": {"kind": "defect", "id": 3, "label": "dent"}, "action": "accept", "revision": 0}
    },
    ("POST", f"{_ONE}/reviews/import"): {"json": {"schema_version": 2, "records": []}},
    ("POST", "/v1/keys"): {"json": {"name": "another", "scopes": ["manage"]}},
    ("POST", "/v1/webhooks"): {"json": {"url": "https://192.0.0.9/"}},
    ("POST", "/v1/accounts"): {"json": {"id": "new"}},
    ("PATCH", "/v1/accounts/{account_id}"): {"json": {"name": "renamed"}},
    ("POST", f"{_ONE}/links"): {"json": {"path": f"artifacts/{_FILE}"}},
    ("POST", "/v1/uploads"): {"headers": {"Upload-Length": "3"}},
    ("PATCH", "/v1/uploads/{upload_id}"): {
        "content": b"abc",
        "headers": {"Upload-Offset": "0", "Content-Type": "application/offset+octet-stream"},
    },
}
UPLOADS = "/v1/uploads"
Headers = dict[str, str]


@dataclass
class Place:
    """A server with one thing of every kind that belongs to the account `mine`."""

    backend: Backend
    client: TestClient = field(init=False)
    names: dict[str, str] = field(init=False)

    def __post_init__(self) -> None:
        self.client = client_of(self.backend)
        application: Any = self.client.app
        application.state.bladeatlas.keys.fresh_s = 0.0  # keys are made and ended behind the server's back
        self.key(Scope.READ)
        files = {"quality.json": b'{"flags": []}', "summary.json": b"{}"}
        files |= dict.fromkeys((f"viewer/{_FILE}", f"models/1/viewer/{_FILE}"), b"{}")
        hook = Webhooks(self.backend.db).create("mine", "https://192.0.0.9/")[0].id
        spare = Keys(self.backend.db).create("spare", "mine", [Scope.MANAGE])[0].id
        self.names = {
            "inspection_id": self.backend.finished("one", files, owner="mine", **ROWS),
            "upload_id": self.backend.services.uploads.create("mine", 3, {}).id,
            "key_id": spare,
            "account_id": "mine",
            "webhook_id": hook,
            "delivery_id": Deliveries(Webhooks(self.backend.db)).test(hook).id,
            "name": "draft",
            "path": _FILE,
            "index": "0",
            "form": "json",
            "model": "1",
        }

    def key(self, *scopes: Scope, account: str = "mine", **more: Any) -> Headers:
        return self.backend.key(account, *scopes, **more)

    def ask(self, route: tuple[str, str], headers: Headers) -> tuple[int, str]:
        """Status and code of the answer."""
        method, template = route
        more = BODIES.get(route, {})
        sent = {**(TUS if template.startswith(UPLOADS) else {}), **more.get("headers", {}), **headers}
        rest = {name: value for name, value in more.items() if name != "headers"}
        answer = self.client.request(method, template.format(**self.names), headers=sent, **rest)
        is_problem = answer.headers.get("content-type", "").startswith("application/problem")
        return answer.status_code, answer.json()["code"] if is_problem and answer.content else ""

    def everywhere(self, headers: Callable[[Scope | None], Headers]) -> dict[tuple[str, str], tuple[int, str]]:
        """What every route answers to headers that are chosen by the scope that it needs."""
        return {route: self.ask(route, headers(scope)) for route, scope in ROUTES.items()}

    def session(self, key: Headers) -> Headers:
        """Headers of a browser that showed this key; as the page that the server itself sent."""
        answer = self.client.post("/v1/session", headers=key)
        assert answer.status_code == 201, answer.text
        said = answer.headers["set-cookie"].lower()
        assert all(word in said for word in ("httponly", "samesite=strict", "path=/", "max-age=43200"))
        self.client.cookies.clear()
        return {"Cookie": f"{COOKIE}={answer.cookies[COOKIE]}", "Origin": "http://127.0.0.1"}


def key_id(key: Headers) -> str:
    """Id of the key in these headers."""
    return key["Authorization"].split("_")[1]
