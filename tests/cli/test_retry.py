"""How long the client goes on."""

from __future__ import annotations

import httpx
import pytest

from cli.client import retry
from cli.client.retry import Transfer, sent_again
from core.errors import BadInput, ResourceError


@pytest.fixture(autouse=True)
def short_pauses(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(retry, "_PAUSE_S", 0.0)


def test_a_transfer_goes_on_as_long_as_it_moves() -> None:
    transfer, calls = Transfer("upload", "a.mp4"), [0]

    def go_on() -> str:
        calls[0] += 1
        if calls[0] == 40:
            return "done"
        if calls[0] % 5 == 0:
            transfer.moved()
        raise httpx.ReadError("cut")

    assert transfer.run(go_on) == "done"


def test_a_transfer_that_stands_still_is_given_up() -> None:
    transfer, calls = Transfer("download", "a.ply"), [0]

    def go_on() -> None:
        calls[0] += 1
        raise httpx.ConnectError("refused")

    with pytest.raises(ResourceError, match=r"download of 'a.ply' was cut off: refused") as caught:
        transfer.run(go_on)
    assert caught.value.code == "download_cut_off"
    assert calls[0] == 6


def test_an_error_that_no_try_mends_ends_a_transfer() -> None:
    calls = [0]

    def go_on() -> None:
        calls[0] += 1
        raise BadInput("no such upload")

    with pytest.raises(BadInput):
        Transfer("upload", "a.mp4").run(go_on)
    assert calls[0] == 1


def test_a_server_that_stays_busy_is_answered_with_what_it_says() -> None:
    answers = iter([httpx.Response(503)] * 5 + [httpx.Response(503, text="last")])
    assert sent_again(lambda: next(answers)).text == "last"
    assert next(answers, None) is None


def test_any_other_answer_is_the_answer() -> None:
    answers = iter([httpx.Response(503), httpx.Response(404), httpx.Response(200)])
    assert sent_again(lambda: next(answers)).status_code == 404
