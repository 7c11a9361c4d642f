"""The short form of the bench with attackers: an honest client is served, and what attacks is held to its limits."""

from __future__ import annotations

from pathlib import Path

import pytest

from bench.service.hostile import hostile

SECONDS = 20.0
IDLE_MS = 60.0
"""99 % of the answers come within so much where a machine has nothing else to do."""


@pytest.mark.deployment
def test_an_honest_client_is_served_beside_attackers(tmp_path: Path) -> None:
    table = hostile(tmp_path, SECONDS)
    found = {row.name: row for row in table.rows}
    value = {name: row.value for name, row in found.items()}

    def number(name: str) -> float:
        return float(str(value[name]))

    said = table.text()
    # What a busy machine takes for itself is not the attackers' doing: two cores serve them, two looks and the stages.
    quiet, under = number("alone: poll, 99 %"), number("attacked: poll, 99 %")
    assert under < (500 if quiet < IDLE_MS else 500 + 25 * quiet), said
    assert number("attacked: inspections that succeeded") >= 1, said
    assert found["attacked: inspections that succeeded"].unit == f"of {value['attacked: inspections that succeeded']}"
    for name in ("alone", "attacked"):
        assert value[f"{name}: requests refused or broken"] == 0, said
        assert value[f"{name}: files whose hash is wrong"] == 0, said
    assert "202" not in found["slow videos answered"].unit, said
    assert "201 100" in found["uploads tried"].unit, "as many as one account may have open"
    assert number("silent readers held") == 100
    assert number("half-open connections held") > 1000
    assert number("server: bytes of log") < 100_000
    assert value["server: exit code"] == 0
