"""XML of strangers: refused in one line, whatever it is."""

from __future__ import annotations

import pytest

from designer.documents.opened import LARGEST_FILE_BYTES
from designer.documents.xml import DEEPEST_NESTING, MAX_ELEMENTS, read_xml
from designer.errors import InputError

BOMB = (
    '<!DOCTYPE a [<!ENTITY b "x"><!ENTITY c "&b;&b;&b;&b;&b;&b;&b;&b;&b;&b;">'
    '<!ENTITY d "&c;&c;&c;&c;&c;&c;&c;&c;&c;&c;">]><a>&d;</a>'
)
SECRET = '<!DOCTYPE a [<!ENTITY b SYSTEM "file:///etc/hostname">]><a>&b;</a>'


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"", "not valid XML"),
        (b"robot: {}", "not valid XML"),
        (b"<a><b></a>", "not valid XML"),
        (b"\x89PNG\r\n\x00\x00", "not valid XML"),
        (b'<?xml version="1.0" encoding="none"?><a/>', "not valid XML"),
        (BOMB.encode(), "declares entities"),
        (SECRET.encode(), "declares entities"),
        (b"<a>" * (DEEPEST_NESTING + 1), "nested more than"),
        (b"<a>" + b"<b/>" * MAX_ELEMENTS + b"</a>", "more than"),
        (b"<a>" + b"x" * LARGEST_FILE_BYTES + b"</a>", "the file has 1 MB"),
    ],
)
def test_what_is_refused(tmp_path, content: bytes, said: str) -> None:
    path = tmp_path / "a.xml"
    path.write_bytes(content)
    with pytest.raises(InputError, match=said) as refused:
        read_xml(path)
    assert len(str(refused.value).splitlines()) == 1


def test_no_file_and_a_folder(tmp_path) -> None:
    with pytest.raises(InputError, match="there is no such file"):
        read_xml(tmp_path / "none.xml")
    with pytest.raises(InputError, match="this is a folder"):
        read_xml(tmp_path)


def test_a_dtd_that_the_file_names_is_not_read(tmp_path) -> None:
    (tmp_path / "a.dtd").write_text('<!ATTLIST a b CDATA "from the DTD">', encoding="utf-8")
    path = tmp_path / "a.xml"
    path.write_text('<!DOCTYPE a SYSTEM "a.dtd">\n<a>\n<b/></a>', encoding="utf-8")
    root = read_xml(path)
    assert root.attributes == {}
    assert (root.line, root.need("b").line) == (2, 3)
