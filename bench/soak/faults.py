"""The faults: each is done to a running deployment and undone by what supervises it."""

from __future__ import annotations

import random
import signal
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field

from redis import Redis, RedisError

from bench.soak.fleet import Fleet
from bench.soak.servers import PostgresServer, RedisServer

_DOWN_S = 1.0
_DUPLICATE_EVERY_S = 0.3
_ENOUGH = 50
_QUEUES = ("bladeatlas.cpu", "bladeatlas.gpu")


@dataclass
class Faults:
    """Does faults to a deployment, chosen by a seeded generator."""

    fleet: Fleet
    redis: RedisServer
    postgres: PostgresServer
    lease_s: float
    rng: random.Random
    transfers: int = 0
    """Uploads, and as many downloads, that are cut off by killing the API."""
    done: list[str] = field(default_factory=list)
    """Names of the faults done, in order."""
    _chosen: int = 0
    _mutex: threading.Lock = field(default_factory=threading.Lock)

    def any(self) -> None:
        """One fault; in the first rounds every kind comes once."""
        kinds: list[Callable[[], None]] = [
            self.kill_worker,
            self.kill_all_workers,
            self.kill_api,
            self.empty_redis,
            self.restart_postgres,
            self.freeze_worker,
        ]
        kind = kinds[self._chosen] if self._chosen < len(kinds) else self.rng.choice(kinds)
        self._chosen += 1
        kind()
        with self._mutex:
            self.done.append(kind.__name__)

    def kill_worker(self) -> None:
        """Kill -9 of one worker."""
        self.fleet.signal(self.rng.choice(self.fleet.workers), signal.SIGKILL)

    def kill_all_workers(self) -> None:
        """Kill -9 of all."""
        for name in self.fleet.workers:
            self.fleet.signal(name, signal.SIGKILL)

    def kill_api(self) -> None:
        """Kill -9 of the API at any moment."""
        self.fleet.signal("api", signal.SIGKILL)

    def in_transfer(self, kind: str) -> None:
        """Kill -9 of the API in the middle of an upload or a download: of some of each kind."""
        name = f"kill_api_during_{kind}"
        with self._mutex:
            if self.done.count(name) < self.transfers:
                self.done.append(name)
                self.fleet.signal("api", signal.SIGKILL)

    def empty_redis(self) -> None:
        """The broker comes back without a memory."""
        self.redis.kill()
        time.sleep(self.rng.uniform(0, _DOWN_S))
        self.redis.start()

    def restart_postgres(self) -> None:
        """Every connection is cut, and for a moment nobody answers."""
        self.postgres.kill()
        time.sleep(self.rng.uniform(0, _DOWN_S))
        self.postgres.start()

    def freeze_worker(self) -> None:
        """One worker stops past its lease and then goes on as if nothing had been."""
        name = self.rng.choice(self.fleet.workers)
        self.fleet.signal(name, signal.SIGSTOP)
        time.sleep(self.lease_s * 1.5)
        self.fleet.signal(name, signal.SIGCONT)


class Duplicates(threading.Thread):
    """Delivers every waiting message twice, all the time."""

    def __init__(self, url: str) -> None:
        super().__init__(daemon=True)
        self._redis: Redis = Redis.from_url(url)
        self._stopped = threading.Event()
        self.sent = 0

    def run(self) -> None:
        """Until stopped."""
        while not self._stopped.wait(_DUPLICATE_EVERY_S):
            for queue in _QUEUES:
                try:
                    waiting = self._redis.lrange(queue, 0, 2)
                    if waiting and self._redis.llen(queue) < _ENOUGH:
                        self._redis.rpush(queue, *waiting)
                        self.sent += len(waiting)
                except RedisError:
                    continue

    def stop(self) -> None:
        """Stop sending messages and wait until the thread has ended."""
        self._stopped.set()
        self.join()
