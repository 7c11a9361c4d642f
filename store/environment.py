"""Deployment settings out of the environment; a variable that nothing reads is an error, not a wish that is ignored."""

from __future__ import annotations

import os

from pydantic import ValidationError
from pydantic_settings import SettingsError

from core.errors import BadInput
from core.names import unknown_name
from store.settings import DeploymentSettings

PREFIX = "BLADEATLAS_"
_OF_CLIENTS = ("SERVER", "API_KEY")
"""What the commands read that talk to a server; see `cli.remote`."""
_OF_TESTS = ("TEST_", "REQUIRE_SERVICES")
"""How the names begin that only the tests read."""


def deployment_settings() -> DeploymentSettings:
    """The settings of this process.

    Raises:
        BadInput: a variable is not known, or its value does not fit; the message names it.
    """
    known = (*(name.upper() for name in DeploymentSettings.model_fields), *_OF_CLIENTS)
    for variable in sorted(os.environ):
        # As `DeploymentSettings` reads them: whether letters are large does not matter.
        name = variable.upper().removeprefix(PREFIX)
        if variable.upper().startswith(PREFIX) and name not in known and not name.startswith(_OF_TESTS):
            message = unknown_name("variable", PREFIX + name, [PREFIX + each for each in known])
            raise BadInput(message, code="unknown_setting", where=variable)
    try:
        return DeploymentSettings()
    except ValidationError as error:
        first = error.errors(include_url=False, include_input=False)[0]
        variable = PREFIX + "_".join(str(part) for part in first["loc"]).upper()
        raise BadInput(f"{variable}: {first['msg']}", code="bad_setting", where=variable) from None
    except SettingsError as error:  # a value that must be JSON; the message names the field and never the value
        raise BadInput(str(error), code="bad_setting", where="environment") from None
