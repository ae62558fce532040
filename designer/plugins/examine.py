"""Asks plugins in processes of their own, and keeps what they answered."""

from __future__ import annotations

import json
import os
import platform
import subprocess
import sys
import threading
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import asdict, dataclass, field
from hashlib import sha256
from importlib.metadata import EntryPoint
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import designer
from designer.plugins import guard

_AT_ONCE = 4
_LONGEST_START_S = 120.0
"""Until Python is up, which has nothing to do with the plugin."""
_GRACE_S = 3.0
"""The process ends its plugin itself; where it cannot, such as in a loop of C, it is ended."""
_MOST_FILES = 2000
_MOST_BYTES = 50_000_000
_START = (
    "import json, sys; sys.path[:] = json.loads(sys.argv.pop(1)); "
    "from designer.plugins.child import main; main(*sys.argv[1:4], float(sys.argv[4]))"
)


@dataclass(frozen=True, slots=True)
class PluginAnswer:
    """What a plugin came to: of each hook that works its items as plain data, and problems."""

    items: Mapping[str, Sequence[Any]] = field(default_factory=dict)
    problems: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class PluginQuestion:
    """A plugin to ask; ``source`` is its distribution with its version."""

    entry: EntryPoint
    source: str
    label: str


def examine(plugins: Sequence[PluginQuestion]) -> list[PluginAnswer]:
    """Return the answer of each, as it is kept where its version and its files are the same.

    A plugin that fails is asked again the next time.
    """
    if not plugins:
        return []
    with ThreadPoolExecutor(_AT_ONCE) as threads:
        return list(threads.map(_kept_or_new, plugins))


def kept_folder() -> Path:
    """Return the folder in which answers are kept."""
    from platformdirs import user_cache_path

    return user_cache_path("cdpr-designer", appauthor=False) / "plugins"


def _kept_or_new(request: PluginQuestion) -> PluginAnswer:
    name = sha256(f"{request.entry.name} {request.entry.value} {sys.prefix}".encode()).hexdigest()
    path = kept_folder() / f"{name[:16]}.json"
    state = _state(request)
    with suppress(OSError, ValueError, TypeError, KeyError):
        cached = json.loads(path.read_bytes())
        if state and cached["state"] == state:
            return _answer(cached["answer"])
    answer = _from_process(request)
    if state and answer.items and not answer.problems:
        with suppress(OSError):
            path.parent.mkdir(parents=True, exist_ok=True)
            unfinished = path.with_suffix(".part")
            unfinished.write_text(json.dumps({"state": state, "answer": asdict(answer)}))
            unfinished.replace(path)
    return answer


def _answer(plain: Mapping[str, Any]) -> PluginAnswer:
    return PluginAnswer(dict(plain["items"]), tuple(map(str, plain["problems"])))


def _state(request: PluginQuestion) -> str:
    """Return a digest of all that an answer depends on; empty where it cannot be told.

    A plugin that is installed to be edited keeps its version while its files change.
    """
    try:
        spec = find_spec(request.entry.module.partition(".")[0])  # imports nothing of the plugin
        assert spec is not None
        roots = spec.submodule_search_locations or [spec.origin or ""]
        files = [line for root in roots for line in _files(Path(root))]
    except Exception:  # of finders of others
        return ""
    if not 0 < len(files) <= _MOST_FILES:
        return ""
    versions = (designer.__version__, platform.python_version(), request.source, request.label)
    return sha256(repr((versions, files)).encode()).hexdigest()


def _files(root: Path) -> Iterator[tuple[str, int, int]]:
    """Yield name, time of change and size of a module's files, one more than are looked at."""
    paths = root.rglob("*") if root.is_dir() else [root]
    for _, path in zip(range(_MOST_FILES + 1), paths, strict=False):
        if path.is_file() and path.parent.name != "__pycache__":
            state = path.stat()
            yield str(path), state.st_mtime_ns, state.st_size


def _from_process(request: PluginQuestion) -> PluginAnswer:
    entry, wait_s = request.entry, guard.LONGEST_WAIT_S
    program = [sys.executable, "-P", "-c", _START, json.dumps(sys.path)]
    process = subprocess.Popen(
        [*program, entry.name, entry.value, request.label, str(wait_s)],
        # Pydantic's own plugins would be looked for, where unreadable metadata end all.
        env={**os.environ, "PYDANTIC_DISABLE_PLUGINS": "__all__"},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
    )
    doing, late = "cannot be loaded", threading.Event()

    def end() -> None:
        late.set()
        process.kill()

    assert process.stdout is not None
    with process, process.stdout as lines:
        limit_s = _LONGEST_START_S
        while True:
            watch = threading.Timer(limit_s, end)
            watch.start()
            line = lines.readline(_MOST_BYTES)
            watch.cancel()
            try:
                message = json.loads(line)
            except ValueError:  # it has ended, or a plugin wrote there in spite of all
                process.kill()
                break
            if "doing" not in message:
                return _answer(message)
            doing, limit_s = message["doing"], wait_s + _GRACE_S
    timeout = f"TimeoutError: no answer within {wait_s:g} s"
    reason = timeout if late.is_set() else "it ended its process"
    return PluginAnswer(problems=(f"{request.label} {doing}: {reason}: left out",))
