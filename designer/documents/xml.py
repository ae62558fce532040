"""Reads an XML file that may be anything into elements that know their lines."""

from __future__ import annotations

import io
import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import NoReturn
from xml.sax.handler import ContentHandler
from xml.sax.xmlreader import AttributesImpl, InputSource, Locator

from designer.documents.document import printable
from designer.documents.opened import read_bytes
from designer.errors import InputError

DEEPEST_NESTING = 64
MAX_ELEMENTS = 100_000


@dataclass(slots=True)
class Element:
    """An element of an XML file, with the file and the line in which it starts."""

    file: str
    line: int
    tag: str
    attributes: dict[str, str] = field(default_factory=dict)
    children: list[Element] = field(default_factory=list)
    text: str = ""

    def everything(self) -> Iterator[Element]:
        """Yield this element, and all within it."""
        yield self
        for child in self.children:
            yield from child.everything()

    def all(self, tag: str) -> Iterator[Element]:
        """Yield the children of this name."""
        return (child for child in self.children if child.tag == tag)

    def find(self, *path: str) -> Element | None:
        """Return the first descendant along a path of names; None if there is none."""
        element: Element | None = self
        for tag in path:
            element = None if element is None else next(element.all(tag), None)
        return element

    def need(self, *path: str) -> Element:
        """Return the same; `InputError` if there is none."""
        element = self.find(*path)
        if element is None:
            self.refuse(f"<{self.tag}> has no <{'/'.join(path)}>", f"<{path[-1]}> in it")
        return element

    def attribute(self, name: str) -> str:
        """Return an attribute; `InputError` if there is none."""
        if name not in self.attributes:
            self.refuse(f"<{self.tag}> has no attribute '{name}'", f"{name}=…")
        return self.attributes[name]

    def number(self, name: str) -> float:
        """Return an attribute as a finite number; `InputError` if it is none."""
        return self.numbers(1, name)[0]

    def numbers(self, count: int, name: str | None = None) -> tuple[float, ...]:
        """Return the finite numbers in the text, or in an attribute; `InputError` otherwise."""
        text = self.text if name is None else self.attribute(name)
        try:
            values = tuple(float(word) for word in text.split())
        except ValueError:
            values = ()
        if len(values) != count or not all(map(math.isfinite, values)):
            expected = "a finite number" if count == 1 else f"{count} finite numbers"
            attribute = "" if name is None else f"{name}="
            content = printable(" ".join(text.split()))[:60]
            self.refuse(f"<{self.tag}> has {attribute}'{content}'", expected)
        return values

    def refuse(self, problem: str, expected: str = "") -> NoReturn:
        """Raise an `InputError` at this line."""
        raise InputError.at(self.file, problem, expected, line=self.line)


class _Builder(ContentHandler):
    """Builds the tree, and stops where it grows beyond any robot's."""

    def __init__(self, file: str) -> None:
        super().__init__()
        self.root: Element | None = None
        self._file, self._open, self._count = file, list[Element](), 0

    def setDocumentLocator(self, locator: Locator) -> None:
        self._locator = locator

    def startElement(self, name: str, attrs: AttributesImpl) -> None:
        line = self._locator.getLineNumber() or 1
        element = Element(self._file, line, name, dict(attrs.items()))
        self._count += 1
        if self._count > MAX_ELEMENTS or len(self._open) >= DEEPEST_NESTING:
            element.refuse(
                f"more than {MAX_ELEMENTS} elements, or nested more than {DEEPEST_NESTING} deep"
            )
        if self._open:
            self._open[-1].children.append(element)
        else:
            self.root = element
        self._open.append(element)

    def endElement(self, name: str) -> None:
        self._open.pop()

    def characters(self, content: str) -> None:
        self._open[-1].text += content


def read_xml(path: Path) -> Element:
    """Return the outermost element of an XML file, as `xml_of` does.

    Raises
    ------
    InputError
        If the file cannot be read, or as there.
    """
    return xml_of(read_bytes(path, str(path), "an XML file"), str(path))


def xml_of(raw: bytes, name: str) -> Element:
    """Return the outermost element of what an XML file, called ``name``, holds.

    Entities are refused, so that a small file cannot grow into a large one, and nothing that the
    file names, such as its DTD, is read.

    Raises
    ------
    InputError
        If it is not XML, declares entities, holds too many elements, or nests too deeply.
    """
    from xml.sax import SAXParseException

    from defusedxml import DefusedXmlException, sax

    builder, parser = _Builder(name), sax.make_parser()
    parser.forbid_external = False  # CASPR's files name a DTD; the parser leaves it unread
    parser.setContentHandler(builder)
    source = InputSource(name)
    source.setByteStream(io.BytesIO(raw))
    try:
        parser.parse(source)
    except SAXParseException as error:
        problem = f"this is not valid XML: {printable(error.getMessage())}"
        raise InputError.at(name, problem, line=error.getLineNumber()) from None
    except DefusedXmlException:
        raise InputError.at(name, "the file declares entities", "none") from None
    except (LookupError, ValueError) as error:  # an encoding that Python or the parser lacks
        problem = f"this is not valid XML: {printable(str(error))}"
        raise InputError.at(name, problem, "XML in UTF-8") from None
    assert builder.root is not None
    return builder.root
