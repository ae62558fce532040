"""Text of templates flows: a sentence that is written over several lines comes out on one."""

from __future__ import annotations

import re
from collections.abc import Iterator

from jinja2.ext import Extension
from jinja2.lexer import Token, TokenStream


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
