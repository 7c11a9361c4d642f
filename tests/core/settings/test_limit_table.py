"""The table of limits: read strictly from CSV and JSON, with one error that names the line."""

from __future__ import annotations

import json

import pytest

from core.errors import BadInput
from core.scene.on_row import Side
from core.settings import make_settings
from core.settings.limits import Limit, parse_limits

TABLE = (
    "zone,damage,span_from,span_to,length_mm,depth_in,count\r\n"
    "Leading edge,Nick,,,0.76,,3\r\n\r\nany,dent,0,0.3,1.5,0.01,\r\n"
)
ROWS = (
    Limit(2, Side.LEADING_EDGE, "Nick", 0.0, 1.0, 0.76, None, 3),
    Limit(4, None, "dent", 0.0, 0.3, 1.5, 25.4 * 0.01, None),
)


def test_csv_and_json_say_the_same() -> None:
    assert parse_limits(TABLE) == ROWS
    assert parse_limits(f"\ufeff{TABLE}") == ROWS
    rows = [
        {"zone": "leading_edge", "damage": "Nick", "length_mm": 0.76, "count": 3},
        {"damage": "dent", "span_to": 0.3, "length_mm": 1.5, "depth_in": 0.01, "count": None},
    ]
    in_json = parse_limits(json.dumps(rows))
    assert [limit.line for limit in in_json] == [1, 2]
    assert [(one.zone, one.length_mm, one.depth_mm, one.count) for one in in_json] == [
        (one.zone, one.length_mm, one.depth_mm, one.count) for one in ROWS
    ]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "no row"),
        ("zone,length_mm\n", "no row"),
        ("zone,lenght_mm\nany,1\n", "line 1 of the table of limits: there is no column 'lenght_mm'"),
        ("zone,zone\nany,any\n", "line 1 .* twice"),
        ("zone,length_mm\nany,1\nblade,2\n", "line 3 .* no zone 'blade'; there are any, concave"),
        ("zone,length_mm\nany,1,2\n", "line 2 .* 3 cells, the header has 2"),
        ("length_mm\n1\n-1\n", "line 3 .* above 0"),
        ("length_mm\nnan\n", "line 2 .* 'nan', which is no number"),
        ("length_mm\n1e999\n", "line 2 .* no number"),
        ("length_mm,length_in\n1,1\n", "line 2 .* both told"),
        ("count\n2.5\n", "line 2 .* no whole number"),
        ("zone,length_mm\nany,\n", "line 2 .* limits nothing"),
        ("span_from,span_to,count\n0.5,0.5,1\n", "line 2 .* span from 0.5 to 0.5 is none"),
        ('zone,count\n"any,1\n', "line 2"),
        ("[1]", "line 1 .* no object"),
        ('[{"count": 1}, {"count": true}]', "line 2 .* neither a text nor a number"),
        ('{"limits": []}', "list of objects"),
        ("[{]", "no JSON"),
        ("count\n" + "1\n" * 1001, "more than 1000 rows"),
        ("damage,count\n" + "x" * 70_000 + ",1\n", "larger than"),
    ],
)
def test_what_is_no_table_is_refused_with_its_line(text: str, said: str) -> None:
    with pytest.raises(BadInput, match=said):
        parse_limits(text)


def test_an_option_of_a_run_is_checked_alike() -> None:
    assert make_settings(options={"limits.table": TABLE}).limits.rows == ROWS
    assert make_settings().limits.rows == ()
    with pytest.raises(BadInput, match="line 2 of the table"):
        make_settings(options={"limits.table": "count\nmany\n"})
