"""The environment of a process: the deployment settings that it holds.

A variable of the prefix that nothing reads is an error, not a wish that is ignored. Secrets may lie in files: for each
of `SECRETS` the variable with `_FILE` behind its name names a file that holds the value.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import ValidationError
from pydantic_settings import SettingsError

from core.errors import BadInput
from core.names import unknown_name
from store.settings import PREFIX, DeploymentSettings

_OF_CLIENTS = ("SERVER", "API_KEY")
"""What the commands read that talk to a server; see `cli.remote`."""
_OF_TESTS = ("TEST_", "REQUIRE_SERVICES")
"""How the names begin that only the tests read."""
SECRETS = (
    "database_url",
    "database_password",
    "broker_url",
    "broker_password",
    "artifacts_options",
    "artifacts_key",
    "artifacts_secret",
)
"""Settings that may lie in a file each."""


def deployment_settings() -> DeploymentSettings:
    """The settings of this process.

    Raises:
        BadInput: a variable is not known, or its value does not fit; the message names it.
    """
    known = (
        *(name.upper() for name in DeploymentSettings.model_fields),
        *(f"{name.upper()}_FILE" for name in SECRETS),
        *_OF_CLIENTS,
    )
    for variable in sorted(os.environ):
        # As `DeploymentSettings` reads them: whether letters are large does not matter.
        name = variable.upper().removeprefix(PREFIX)
        if variable.upper().startswith(PREFIX) and name not in known and not name.startswith(_OF_TESTS):
            message = unknown_name("variable", PREFIX + name, [PREFIX + each for each in known])
            raise BadInput(message, code="unknown_setting", where=variable)
    try:
        return DeploymentSettings(**_from_files(os.environ))
    except ValidationError as error:
        first = error.errors(include_url=False, include_input=False)[0]
        variable = PREFIX + "_".join(str(part) for part in first["loc"]).upper()
        said = first["msg"].removeprefix("Value error, ")
        raise BadInput(f"{variable}: {said}", code="bad_setting", where=variable) from None
    except SettingsError as error:  # a value that must be JSON; the message names the field and never the value
        raise BadInput(str(error), code="bad_setting", where="environment") from None


def _from_files(environment: Mapping[str, str]) -> dict[str, Any]:
    """Values of the settings whose files the environment names, without the line break at their end.

    Raises:
        BadInput: a setting is given both ways, or its file cannot be read, or is no JSON where that is asked for.
    """
    found: dict[str, Any] = {}
    given = {name.upper(): value for name, value in environment.items()}
    for name in SECRETS:
        variable = f"{PREFIX}{name.upper()}_FILE"
        if not given.get(variable):
            continue
        if given.get(variable.removesuffix("_FILE")):
            message = f"{variable.removesuffix('_FILE')} and {variable} are both set; one of them is enough"
            raise BadInput(message, code="bad_setting", where=variable)
        try:
            text = Path(given[variable]).read_text(encoding="utf-8").removesuffix("\n").removesuffix("\r")
            found[name] = json.loads(text) if name == "artifacts_options" else text
        except OSError as error:
            message = f"{variable}: the file '{given[variable]}' cannot be read: {error.strerror}"
            raise BadInput(message, code="bad_setting", where=variable) from None
        except ValueError:
            kind = "JSON" if name == "artifacts_options" else "UTF-8 text"
            message = f"{variable}: the file '{given[variable]}' holds no {kind}"
            raise BadInput(message, code="bad_setting", where=variable) from None
    return found
