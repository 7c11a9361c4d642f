"""Pages of the documentation that are made from the code: a hook of mkdocs (`mkdocs.yml`).

Settings, environment variables, commands and HTTP calls are described where they are declared. Their pages are made
from these declarations whenever the site is built, so that no page can say something else than the program does.
"""

from __future__ import annotations

import argparse
import json
import re
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import groupby
from pathlib import Path
from typing import Any

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page
from pydantic import SecretStr

from api.app import create_app
from api.services import services_from
from bench.main import make_parser
from cli.arguments import parser
from core.settings import PRESET_NAMES, Settings
from core.settings.base import Group
from core.settings.describe import OptionInfo, describe_options
from store.environment import SECRETS
from store.settings import DeploymentSettings

ROOT = Path(__file__).parents[1]
INCLUDE = re.compile(r"<!-- include README\.md: ([\w -]+) -->")
"""Where a page shows a block of the README that is marked with this name."""


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages that are made."""
    for path, make in PAGES.items():
        files.append(File.generated(config, path, content=make()))
    return files


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Put blocks of the README where a page asks for them."""
    return INCLUDE.sub(lambda found: readme_block(found[1]), markdown)


def readme_block(name: str) -> str:
    """The text of the README between ``<!-- name -->`` and ``<!-- end -->``."""
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    found = re.search(rf"<!-- {re.escape(name)} -->\n(.*?)<!-- end -->", readme, re.DOTALL)
    if found is None:
        raise ValueError(f"README.md has no block '{name}'")
    return found[1]


def table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A Markdown table; bars and line breaks in cells are kept as text."""
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(_cell(cell) for cell in line) + " |" for line in lines) + "\n"


def _cell(text: str) -> str:
    # Bars in code end no cell, and a backslash before them would be shown.
    parts = " ".join(text.split()).split("`")
    return "`".join(part if number % 2 else part.replace("|", "\\|") for number, part in enumerate(parts))


def _sentence(text: str) -> str:
    text = " ".join(text.split())
    return text[:1].upper() + text[1:] + ("" if text.endswith((".", ":")) else ".") if text else ""


def settings_page() -> str:
    """Every option of the method, in groups."""
    parts = [
        "# Settings\n",
        "Options of the method, for `--set NAME=VALUE`, for `options` in a file of parameters, and for the service's",
        "`parameters`.",
        "A default is the value of the preset `default`; where another preset has another value, it is named.",
        "`bladeatlas options` prints the same list. Unknown names are refused.\n",
    ]
    for group, options in groupby(describe_options(), key=lambda one: one.name.partition(".")[0]):
        parts += [f"\n## {group}\n", _sentence(_group_meaning(group)), ""]
        parts.append(
            table(("option", "default", "allowed", "meaning", "source"), [_option_row(one) for one in options])
        )
    return "\n".join(parts)


def _group_meaning(group: str) -> str:
    kind = Settings.model_fields[group].annotation
    documented = isinstance(kind, type) and issubclass(kind, Group)
    return (kind.__doc__ or "").partition("\n\n")[0] if documented else ""


def _option_row(one: OptionInfo) -> tuple[str, ...]:
    others = [f"{name}: {_value(one.presets[name], '')}" for name in PRESET_NAMES if name in one.presets]
    default = "; ".join([_value(one.default, one.unit), *others])
    allowed = ", ".join(f"`{part}`" for part in one.range.split("|")) if "|" in one.range else one.range
    return f"`{one.name}`", default, allowed, one.meaning, one.source


def _value(value: Any, unit: str) -> str:
    return f"`{json.dumps(value)}` {unit}".strip()


def environment_page() -> str:
    """Every variable that the server and its workers read."""
    rows = []
    for name, field in DeploymentSettings.model_fields.items():
        default = field.get_default(call_default_factory=False)
        shown = "empty" if default in ("", {}, SecretStr("")) else _default(default)
        file = "; also in a file, `_FILE`" if name in SECRETS else ""
        rows.append((f"`BLADEATLAS_{name.upper()}`", shown, f"{field.description}{file}"))
    return "\n".join(
        [
            "# Environment variables\n",
            "What differs between machines. A variable of this prefix that nothing reads, or a value that does not",
            "fit, ends the program with exit code 2 and the nearest name. Where the meaning says so, a variable with",
            "`_FILE` behind its name may name a file that holds the value instead. How to choose them:",
            "[deploying](../operations/deploying.md).\n",
            table(("variable", "default", "meaning"), rows),
        ]
    )


def _default(value: object) -> str:
    return f"`{value:,}`" if isinstance(value, int) else f"`{value}`"


def command_page() -> str:
    """Every command with its arguments."""
    parts = ["# Command line\n", "`bladeatlas COMMAND --help` prints the same.\n"]
    for program in (parser(), make_parser()):
        parts += [f"\n## {program.prog}\n", _sentence((program.description or "").split("\n")[0]), ""]
        parts += [_sentence(program.epilog or ""), ""]
        for command in _commands(program):
            parts += [f"\n### {command.prog}\n", _sentence(command.description or _help(program, command)), ""]
            parts += [f"```text\n{command.format_usage().strip()}\n```\n", _arguments(command)]
    return "\n".join(parts)


def _commands(program: argparse.ArgumentParser) -> Iterator[argparse.ArgumentParser]:
    """The subcommands, those of subcommands included."""
    for action in program._actions:
        if isinstance(action, argparse._SubParsersAction):
            for command in action.choices.values():
                yield command
                yield from _commands(command)


def _help(program: argparse.ArgumentParser, command: argparse.ArgumentParser) -> str:
    actions = [action for action in program._actions if isinstance(action, argparse._SubParsersAction)]
    texts = {choice.dest: choice.help or "" for action in actions for choice in action._choices_actions}
    return texts.get(command.prog.split()[-1], "")


def _arguments(command: argparse.ArgumentParser) -> str:
    rows = []
    for action in command._actions:
        if isinstance(action, argparse._HelpAction | argparse._SubParsersAction):
            continue
        metavar = action.metavar if isinstance(action.metavar, str) else action.dest.upper()
        name = ", ".join(action.option_strings) or metavar
        value = f" {metavar}" if action.option_strings and action.nargs != 0 else ""
        need = " (required)" if action.option_strings and action.required else ""
        rows.append((f"`{name}{value}`", (action.help or "") + need))
    return table(("argument", "meaning"), rows) if rows else ""


def http_page() -> str:
    """Every call of the service and every object that it takes or answers with."""
    document = openapi_document()
    calls = [
        (method, path, call)
        for path, methods in document["paths"].items()
        for method, call in methods.items()
        if method != "parameters"
    ]
    parts = [
        "# HTTP calls\n",
        "How calls belong together is in the [guide](../api.md). A server describes the same calls at `/openapi.json`,",
        "`/docs` and `/redoc`.\n",
    ]
    for tag in dict.fromkeys(call["tags"][0] for _, _, call in calls):
        parts.append(f"\n## {_sentence(tag)[:-1]}\n")
        for method, path, call in calls:
            if call["tags"][0] == tag:
                parts.append(_call(method, path, call))
    parts.append("\n## Objects\n")
    parts += [_schema(name, schema) for name, schema in sorted(document["components"]["schemas"].items())]
    return "\n".join(parts)


def openapi_document() -> dict[str, Any]:
    """OpenAPI as a server with an empty data folder serves it, whatever the environment says."""
    with tempfile.TemporaryDirectory() as folder:
        settings = DeploymentSettings(data_dir=Path(folder), database_url="", broker_url="", artifacts_url="")
        services = services_from(settings)
        document = create_app(services).openapi()
        services.db.engine.dispose()
    return document


def _call(method: str, path: str, call: Mapping[str, Any]) -> str:
    parts = [f"\n### {call['summary']}\n", f"```http\n{method.upper()} {path}\n```\n", call.get("description", ""), ""]
    given = [
        (f"`{one['name']}`", one["in"], _type(one.get("schema", {})), one.get("description", ""))
        for one in call.get("parameters", [])
    ]
    if given:
        parts.append(table(("parameter", "in", "type", "meaning"), given))
    bodies = call.get("requestBody", {}).get("content", {})
    for media, body in bodies.items():
        parts.append(f"Body: `{media}` {_type(body.get('schema', {}))}\n")
    answers = call["responses"].items()
    parts.append(
        table(
            ("status", "answer"),
            [(f"`{status}`", _answer(answer)) for status, answer in answers if status != "default"],
        )
    )
    return "\n".join(parts)


def _answer(answer: Mapping[str, Any]) -> str:
    kinds = {_type(body.get("schema", {})) for body in answer.get("content", {}).values()} - {""}
    return " ".join([answer.get("description", ""), f"({', '.join(sorted(kinds))})" if kinds else ""])


def _schema(name: str, schema: Mapping[str, Any]) -> str:
    parts = [f"\n### {name}\n", schema.get("description", ""), ""]
    required = schema.get("required", [])
    fields = [
        (f"`{field}`", _type(kind), "" if field in required else "yes", kind.get("description", ""))
        for field, kind in schema.get("properties", {}).items()
    ]
    if fields:
        parts.append(table(("field", "type", "optional", "meaning"), fields))
    return "\n".join(parts)


def _type(schema: Mapping[str, Any]) -> str:
    """A JSON Schema in a few words, objects as links to their tables."""
    if "$ref" in schema:
        name = schema["$ref"].rsplit("/", 1)[1]
        return f"[{name}](#{name.lower()})"
    for key in ("anyOf", "oneOf", "allOf"):
        if key in schema:
            return " or ".join(dict.fromkeys(_type(one) for one in schema[key]))
    if "enum" in schema:
        return ", ".join(f"`{value}`" for value in schema["enum"])
    if schema.get("type") == "array":
        return f"list of {_type(schema.get('items', {})) or 'any'}"
    return str(schema.get("type", ""))


PAGES: Mapping[str, Callable[[], str]] = {
    "reference/settings.md": settings_page,
    "reference/environment.md": environment_page,
    "reference/command-line.md": command_page,
    "reference/http.md": http_page,
}
"""Path of each page that is made below docs/, and what makes it."""
