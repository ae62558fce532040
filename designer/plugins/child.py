"""The process that looks at one plugin: there it may exit, block or never end.

It writes lines of JSON: what it is at, before that may go wrong, and the answer at last.
"""

from __future__ import annotations

import json
import os
from contextlib import suppress
from functools import partial
from importlib import import_module
from importlib.metadata import EntryPoint
from typing import Any

from designer.plugins import guard
from designer.plugins.hooks import ENTRY_POINT_GROUP, PLAIN, hooks_of, listed

_MOST_MEMORY_BYTES = 4 << 30
_MOST_PROCESSOR_S = 120


def main(name: str, value: str, label: str, longest_wait_s: float) -> None:
    """Load the plugin of an entry point, and answer with what its hooks give."""
    out = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)  # what the plugin itself prints below Python goes to standard error
    limit(_MOST_MEMORY_BYTES, _MOST_PROCESSOR_S)
    guard.LONGEST_WAIT_S = longest_wait_s
    plain = {hook: import_module(module) for hook, module in PLAIN.items()}

    def say(**message: Any) -> None:
        out.write(f"{json.dumps(message)}\n")
        out.flush()

    problems: list[str] = []
    items: dict[str, list[Any]] = {}
    say(doing=(failure := "cannot be loaded"))
    entry = EntryPoint(name, value, ENTRY_POINT_GROUP)
    hooks = guard.attempt(partial(hooks_of, entry), label, failure, problems)
    for hook, function in (hooks or {}).items():
        say(doing=(failure := f"fails in {hook}()"))
        answer = guard.attempt(partial(listed, function), label, failure, problems)
        if answer is not None:
            items[hook] = [*map(plain[hook].to_plain, answer)] if hook in plain else []
    say(items=items, problems=problems)
    os._exit(0)  # a thread of the plugin may still be at work


def limit(memory_bytes: int, processor_s: int) -> None:
    """Limit what this process may take, where the system can."""
    with suppress(ImportError, ValueError, OSError):  # Windows has none, macOS not all
        import resource

        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        resource.setrlimit(resource.RLIMIT_CPU, (processor_s, processor_s))
        resource.setrlimit(resource.RLIMIT_AS, (memory_bytes, memory_bytes))
