"""Tests of services: skipped where the service is absent, and the last line says how many and which.

With ``BLADEATLAS_REQUIRE_SERVICES=1`` an absent service fails the test instead.
"""

from __future__ import annotations

import os
import socket
import sys
from collections import Counter
from collections.abc import Iterator
from urllib.parse import urlsplit

import pytest

from tests.store.object_store import s3_server

SERVICES = {
    "postgresql": ("BLADEATLAS_TEST_POSTGRESQL_URL", "postgresql://postgres@127.0.0.1:5432/test"),
    "redis": ("BLADEATLAS_TEST_REDIS_URL", "redis://127.0.0.1:6379/15"),
    "rabbitmq": ("BLADEATLAS_TEST_RABBITMQ_URL", "amqp://guest:guest@127.0.0.1:5672//"),
}
_SKIPPED = pytest.StashKey[Counter[str]]()


def service_url(name: str) -> str:
    """Where the tests look for a service: the environment's address, or the usual port of this machine."""
    variable, usual = SERVICES[name]
    return os.environ.get(variable, usual)


def _answers(url: str) -> bool:
    parts = urlsplit(url)
    try:
        with socket.create_connection((parts.hostname or "127.0.0.1", parts.port or 0), timeout=1.0):
            return True
    except OSError:
        return False


def pytest_configure(config: pytest.Config) -> None:
    config.stash[_SKIPPED] = Counter()


def pytest_runtest_setup(item: pytest.Item) -> None:
    for marker in item.iter_markers("service"):
        name = str(marker.args[0])
        if name not in SERVICES:
            pytest.fail(f"unknown service '{name}'; known: {', '.join(SERVICES)}")
        if _answers(service_url(name)):
            continue
        if os.environ.get("BLADEATLAS_REQUIRE_SERVICES") == "1":
            pytest.fail(f"{name} does not answer at {service_url(name)}, and BLADEATLAS_REQUIRE_SERVICES=1")
        item.config.stash[_SKIPPED][name] += 1
        pytest.skip(f"{name} does not answer at {service_url(name)}")


def pytest_unconfigure(config: pytest.Config) -> None:
    if hasattr(config, "workerinput") or config.option.collectonly:
        return
    sys.stdout.write(skipped_line(config.stash.get(_SKIPPED, Counter())) + "\n")


def skipped_line(skipped: Counter[str]) -> str:
    """The last line of a test run."""
    if not skipped:
        return "services: no test was skipped for an absent service"
    names = ", ".join(f"{name} ({count})" for name, count in sorted(skipped.items()))
    return f"services: {sum(skipped.values())} tests skipped, absent: {names}"


@pytest.fixture
def postgresql_url() -> str:
    return service_url("postgresql")


@pytest.fixture
def redis_url() -> str:
    return service_url("redis")


@pytest.fixture(scope="session")
def s3() -> Iterator[str]:
    """Address of an S3 server."""
    with s3_server() as address:
        yield address
