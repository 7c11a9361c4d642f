"""Turns go round the owners, wait within bounds, and are never lost."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable

import pytest

from api.problems import Refused
from api.turns import Turns


class Work:
    """Jobs that end when the test says so."""

    def __init__(self, turns: Turns) -> None:
        self.turns = turns
        self.begun: list[str] = []
        self._ends: list[asyncio.Event] = []

    async def job(self, owner: str) -> None:
        async with self.turns.turn(owner):
            end = asyncio.Event()
            self.begun.append(owner)
            self._ends.append(end)
            await end.wait()

    async def start(self, *owners: str) -> list[asyncio.Task[None]]:
        tasks = [asyncio.create_task(self.job(owner)) for owner in owners]
        await settle()
        return tasks

    async def end_one(self) -> None:
        self._ends.pop(0).set()
        await settle()


async def settle() -> None:
    for _ in range(10):
        await asyncio.sleep(0)


def run(test: Callable[[], Awaitable[None]]) -> None:
    async def whole() -> None:
        await test()

    asyncio.run(whole())


def test_the_next_turn_is_of_who_has_none() -> None:
    async def test() -> None:
        work = Work(Turns(2, 200, 200, 60))
        await work.start(*"a" * 100)
        await work.start("b")
        assert work.begun == ["a", "a"]
        await work.end_one()
        assert work.begun[2:] == ["b"], "behind 98 of another owner, and next"

    run(test)


def test_one_more_begins_at_once_for_who_has_none() -> None:
    async def test() -> None:
        work = Work(Turns(2, 200, 200, 60, spare=1))
        await work.start(*"aaa", *"bb", "c")
        assert work.begun == ["a", "a", "b"], "the third is no other one of an account that has two"
        await work.end_one()
        assert work.begun[3:] == ["c"]
        await work.end_one()
        assert work.begun[4:] == ["a"], "which has none by now"

    run(test)


def test_turns_go_round() -> None:
    async def test() -> None:
        work = Work(Turns(1, 200, 200, 60))
        await work.start(*"aaaaa", *"bb", "c")
        for _ in range(7):
            await work.end_one()
        assert "".join(work.begun) == "abcabaaa"

    run(test)


def test_the_line_is_bounded() -> None:
    async def test() -> None:
        turns = Turns(1, 3, 2, 60)
        work = Work(turns)
        tasks = await work.start(*"aaaa", "b", "c")
        refused = [task.exception() for task in tasks if task.done()]
        assert [(e.status, e.code) for e in refused if isinstance(e, Refused)] == [
            (429, "too_many_probes_of_owner"),
            (503, "too_many_probes"),
        ]
        assert all(isinstance(error, Refused) and error.headers["Retry-After"] for error in refused)
        assert turns.waiting == 3

    run(test)


def test_nobody_waits_without_an_end() -> None:
    async def test() -> None:
        turns = Turns(1, 10, 10, 0.05)
        work = Work(turns)
        _, waiting = await work.start("a", "b")
        with pytest.raises(Refused) as caught:
            await waiting
        assert (caught.value.status, caught.value.code) == (503, "probe_wait")
        assert turns.waiting == 0
        turns.wait_s = 0.0
        with pytest.raises(Refused, match=r"within 0 s \("):  # a whole number of seconds has no decimals
            async with turns.turn("b"):
                pass

    run(test)


def test_who_leaves_takes_no_turn_along() -> None:
    async def test() -> None:
        turns = Turns(1, 10, 10, 60)
        work = Work(turns)
        first, *others = await work.start(*"abcd")
        others[0].cancel()
        await settle()
        assert turns.waiting == 2
        # Cancelled in the moment in which its turn comes, and in the one before.
        work._ends[0].set()
        await asyncio.sleep(0)
        others[1].cancel()
        await settle()
        assert work.begun == ["a", "d"]
        others[2].cancel()
        await settle()
        await work.start("e")
        assert work.begun[-1] == "e"
        assert first.done()

    run(test)
