"""The schema for editors that is shipped.

Apart from the tests of what it says: older versions of pydantic write the same in other words.
"""

from __future__ import annotations

from designer.effects.registry import SHIPPED
from designer.io.config.json_schema import schema_text
from designer.io.config.moved import SCHEMA_FILE
from designer.resources import example_file


def test_the_shipped_file_is_what_is_generated() -> None:
    shipped = example_file("fast").with_name(SCHEMA_FILE).read_text(encoding="utf-8")
    told = f"designer schema --no-plugins -o designer/examples/{SCHEMA_FILE}"
    assert shipped == schema_text(SHIPPED.by_id), f"write it again: {told}"
