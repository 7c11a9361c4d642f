"""Retry policies towards a server: requests are sent again after growing pauses, transfers while they get ahead."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

import httpx
from tenacity import (
    RetryCallState,
    RetryError,
    Retrying,
    retry_if_exception_type,
    retry_if_result,
    stop_after_attempt,
    wait_exponential,
)

from core.errors import ResourceError

T = TypeVar("T")
_TRIES = 6
_PAUSE_S = 0.5
_LONGEST_PAUSE_S = 10.0


def sent_again(send: Callable[[], httpx.Response]) -> httpx.Response:
    """The answer of a request that may be sent twice; the last one where the server is busy to the end.

    Raises:
        ResourceError: the server does not answer.
    """
    policy = Retrying(
        retry=retry_if_exception_type(httpx.TransportError) | retry_if_result(_is_busy),
        wait=wait_exponential(multiplier=_PAUSE_S, max=_LONGEST_PAUSE_S),
        stop=stop_after_attempt(_TRIES),
        retry_error_callback=_last_answer,  # instead of an error of the library
    )
    try:
        return policy(send)
    except httpx.TransportError as error:
        raise ResourceError(f"the server does not answer: {error}", code="unreachable") from None


def _is_busy(response: httpx.Response) -> bool:
    return response.status_code == httpx.codes.SERVICE_UNAVAILABLE


def _last_answer(state: RetryCallState) -> httpx.Response:
    assert state.outcome is not None  # of the try that was the last
    answer: httpx.Response = state.outcome.result()
    return answer


class Transfer:
    """A transfer that goes on where it was cut off, until too many tries in a row have moved nothing.

    Args:
        kind: ``upload`` or ``download``.
        name: the file, as errors name it.
    """

    def __init__(self, kind: str, name: str) -> None:
        self._kind, self._name = kind, name
        self._failures = 0

    def moved(self) -> None:
        """Note that bytes have arrived since the last failure."""
        self._failures = 0

    def run(self, go_on: Callable[[], T]) -> T:
        """Call until it ends well.

        Raises:
            ResourceError: the server stays away; another call goes on from there.
        """
        policy = Retrying(
            retry=retry_if_exception_type((httpx.TransportError, ResourceError)),
            wait=lambda _state: min(_LONGEST_PAUSE_S, _PAUSE_S * 2**self._failures),
            stop=self._is_stalled,
        )
        try:
            return policy(go_on)
        except RetryError as stalled:
            error = stalled.last_attempt.exception()
            message = f"the {self._kind} of '{self._name}' was cut off: {error}; the same command goes on from there"
            raise ResourceError(message, code=f"{self._kind}_cut_off") from None

    def _is_stalled(self, _state: RetryCallState) -> bool:
        self._failures += 1
        return self._failures >= _TRIES
