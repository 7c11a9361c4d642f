"""Who may run, and when a worker asks by itself."""

from __future__ import annotations

import threading
import time
from collections.abc import Sequence

from tests.worker.deployment import wait_for
from worker.loop import ConcurrencyLimit


class Work:
    """Tasks that wait to be let go; notes what ran and how many at once."""

    def __init__(self, tasks: int) -> None:
        self.left = tasks
        self.ran: list[tuple[str, ...]] = []
        self.running = self.most = 0
        self.gate = threading.Event()
        self._lock = threading.Lock()

    def run_next(self, queues: Sequence[str]) -> bool:
        with self._lock:
            if not self.left:
                return False
            self.left -= 1
            self.running += 1
            self.most = max(self.most, self.running)
        self.gate.wait(10.0)
        with self._lock:
            self.running -= 1
            self.ran.append(tuple(queues))
        return True


def test_a_worker_without_messages_does_all_there_is() -> None:
    work = Work(3)
    work.gate.set()
    ConcurrencyLimit(1, work.run_next, threading.Event(), quiet_s=0.0).without_message(("cpu", "gpu"))
    assert work.ran == [("cpu", "gpu")] * 3


def test_a_worker_that_just_heard_a_message_leaves_the_rest_to_the_broker() -> None:
    work = Work(3)
    work.gate.set()
    limit = ConcurrencyLimit(1, work.run_next, threading.Event(), quiet_s=60.0)
    limit.on_message("cpu")
    limit.without_message(("cpu",))
    assert work.ran == [("cpu",)]


def test_messages_and_own_looks_share_the_limit() -> None:
    work = Work(4)
    limit = ConcurrencyLimit(1, work.run_next, threading.Event(), quiet_s=0.0)
    threads = [threading.Thread(target=limit.on_message, args=("cpu",)) for _ in range(2)]
    threads += [threading.Thread(target=limit.without_message, args=(("cpu",),))]
    for thread in threads:
        thread.start()
    wait_for(lambda: work.running == 1)
    time.sleep(0.2)
    work.gate.set()
    for thread in threads:
        thread.join(10.0)
    assert work.most == 1
    assert len(work.ran) >= 2


def test_a_stopping_worker_starts_nothing() -> None:
    work, stopped = Work(2), threading.Event()
    limit = ConcurrencyLimit(1, work.run_next, stopped, quiet_s=0.0)
    first = threading.Thread(target=limit.on_message, args=("cpu",))
    first.start()
    wait_for(lambda: work.running == 1)
    stopped.set()
    limit.on_message("cpu")
    limit.without_message(("cpu",))
    work.gate.set()
    first.join(10.0)
    assert len(work.ran) == 1
