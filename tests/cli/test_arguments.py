"""Every command finds what runs it."""

from __future__ import annotations

import argparse
import importlib

import pytest

from cli.arguments import parser


def commands() -> dict[str, argparse.ArgumentParser]:
    (action,) = (one for one in parser()._actions if isinstance(one, argparse._SubParsersAction))
    return dict(action.choices)


@pytest.mark.parametrize("name", commands())
def test_a_command_has_a_function_that_takes_its_arguments(name: str) -> None:
    command = commands()[name]
    run = getattr(importlib.import_module(command.get_default("module")), command.get_default("function"))
    assert callable(run)
    assert run.__code__.co_argcount == 1
    assert run.__name__ in (name, "command")


def test_the_commands_are_those_of_the_contract() -> None:
    assert {
        "run",
        "serve",
        "worker",
        "submit",
        "status",
        "watch",
        "download",
        "cancel",
        "keys",
        "webhooks",
    } <= commands().keys()
    assert {"probe", "check", "point", "views", "options", "version"} <= commands().keys()
