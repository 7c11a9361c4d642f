"""Who may run, and when a worker asks by itself."""

from __future__ import annotations

import threading
import time

from tests.waiting import wait_for
from worker.loop import ConcurrencyLimit


class Work:
    """Tasks that wait to be let go; notes what each start was told, and how many ran at once."""

    def __init__(self, tasks: int) -> None:
        self.left = tasks
        self.ran: list[object] = []
        self.running = self.most = 0
        self.gate = threading.Event()
        self._lock = threading.Lock()

    def run_next(self, overdue_s: float | None) -> bool:
        return self._run(overdue_s)

    def run_named(self) -> str | None:
        return "done" if self._run("named") else None

    def _run(self, told: object) -> bool:
        with self._lock:
            if not self.left:
                return False
            self.left -= 1
            self.running += 1
            self.most = max(self.most, self.running)
        self.gate.wait(10.0)
        with self._lock:
            self.running -= 1
            self.ran.append(told)
        return True


def test_a_worker_without_messages_begins_with_what_nobody_heard_of_and_does_all_there_is() -> None:
    work = Work(3)
    work.gate.set()
    ConcurrencyLimit(1, threading.Event(), quiet_s=0.0).without_message(work.run_next)
    assert work.ran == [0.0, None, None]


def test_a_worker_that_just_heard_a_message_leaves_the_rest_to_the_broker() -> None:
    work = Work(3)
    work.gate.set()
    limit = ConcurrencyLimit(1, threading.Event(), quiet_s=60.0)
    assert limit.on_message(work.run_named) == "done"
    limit.without_message(work.run_next)
    assert work.ran == ["named"]


def test_messages_and_own_looks_share_the_limit() -> None:
    work = Work(4)
    limit = ConcurrencyLimit(1, threading.Event(), quiet_s=0.0)
    threads = [threading.Thread(target=limit.on_message, args=(work.run_named,)) for _ in range(2)]
    threads += [threading.Thread(target=limit.without_message, args=(work.run_next,))]
    for thread in threads:
        thread.start()
    wait_for(lambda: work.running == 1)
    time.sleep(0.2)
    work.gate.set()
    for thread in threads:
        thread.join(10.0)
    assert work.most == 1
    assert len(work.ran) >= 2


def test_a_message_that_waits_goes_before_the_next_own_look() -> None:
    work = Work(3)
    limit = ConcurrencyLimit(1, threading.Event(), quiet_s=0.0)
    looking = threading.Thread(target=limit.without_message, args=(work.run_next,))
    looking.start()
    wait_for(lambda: work.running == 1)
    message = threading.Thread(target=limit.on_message, args=(work.run_named,))
    message.start()
    time.sleep(0.2)
    work.gate.set()
    looking.join(10.0)
    message.join(10.0)
    assert work.ran == [0.0, "named"]


def test_the_end_of_a_messages_task_is_no_silence_however_long_it_took() -> None:
    work = Work(2)
    limit = ConcurrencyLimit(1, threading.Event(), quiet_s=0.5)
    message = threading.Thread(target=limit.on_message, args=(work.run_named,))
    message.start()
    time.sleep(0.8)
    work.gate.set()
    message.join(10.0)
    limit.without_message(work.run_next)
    assert work.ran == ["named"]
    time.sleep(0.6)
    limit.without_message(work.run_next)
    assert work.ran == ["named", 0.5]


def test_a_stopping_worker_starts_nothing() -> None:
    work, stopped = Work(2), threading.Event()
    limit = ConcurrencyLimit(1, stopped, quiet_s=0.0)
    first = threading.Thread(target=limit.on_message, args=(work.run_named,))
    first.start()
    wait_for(lambda: work.running == 1)
    stopped.set()
    assert limit.on_message(work.run_named) is None
    limit.without_message(work.run_next)
    work.gate.set()
    first.join(10.0)
    assert len(work.ran) == 1
