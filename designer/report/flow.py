"""What Jinja is given: text that flows, and a place to keep templates that are compiled."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import suppress
from functools import cache
from hashlib import sha256
from importlib.metadata import version
from pathlib import Path

from jinja2 import BytecodeCache
from jinja2.bccache import Bucket
from jinja2.ext import Extension
from jinja2.lexer import Token, TokenStream

from designer import __version__
from designer.io.output import cache_path, write_cache


class FlowingText(Extension):
    """Joins the lines of sentences, so that each can be found in the page as a whole.

    Lines that end or begin with a tag stay, and so does what is no template of HTML.
    """

    def filter_stream(self, stream: TokenStream) -> Iterator[Token]:
        """Yield the tokens of a template."""
        flows = (stream.name or "").endswith(".html.j2")
        for token in stream:
            if flows and token.type == "data":
                yield Token(token.lineno, token.type, _joined(token.value))
            else:
                yield token


def _joined(text: str) -> str:
    return re.sub(r"(?<![>\s])[ \t]*\n[ \t]*(?![<\s])", " ", text)


class KeptTemplates(BytecodeCache):
    """Templates as Python's code, kept for other runs; to compile them takes longer than to fill.

    Jinja tells whether code is of the source at hand. Beyond that, it is only taken as it was
    written, since the interpreter does not survive a byte that is wrong, and of these filters:
    what they make of a constant is in the code.
    """

    def load_bytecode(self, bucket: Bucket) -> None:
        """Give what is kept, if anything."""
        with suppress(OSError):
            content = _path(bucket).read_bytes()
            if content[:32] == _digest(content[32:]):
                bucket.bytecode_from_string(content[32:])

    def dump_bytecode(self, bucket: Bucket) -> None:
        """Keep code, over that of an older source."""
        code = bucket.bytecode_to_string()
        write_cache(_path(bucket), _digest(code) + code)


def _path(bucket: Bucket) -> Path:
    return cache_path("templates", bucket.key)


def _digest(code: bytes) -> bytes:
    return sha256(_filters() + code).digest()


@cache
def _filters() -> bytes:
    """Return a digest of all that takes part in compiling besides a template's source."""
    versions = f"{__version__} {version('jinja2')}".encode()
    sources = sorted(Path(__file__).parent.rglob("*.py"))
    return sha256(b"".join([versions, *(path.read_bytes() for path in sources)])).digest()
