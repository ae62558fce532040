"""The program: ``designer``, and ``python -m designer``.

What is here comes before all else is loaded, so it answers Ctrl-C and faults of that as well.
"""

from __future__ import annotations

import os
import signal
import sys


def main() -> None:
    """Run the command line; whatever else goes wrong is one line, with a status of its own."""
    if signal.getsignal(signal.SIGINT) is not signal.SIG_IGN:  # as in a background job
        signal.signal(signal.SIGINT, _leave)
    # Pydantic looks for plugins of its own, and a distribution that is unreadable ends the search.
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    try:
        from designer.cli.commands import main as run

        run()
    except Exception as error:
        from designer.cli.crash import end_by_fault

        end_by_fault(error)


def _leave(number: int, _: object) -> None:
    """Leave while libraries are still loaded: an exception would come up inside of them."""
    try:
        if sys.stderr is not None and sys.stderr.isatty():
            os.write(2, b"\n")  # behind the terminal's ^C
        os.write(2, b"Interrupted; nothing was written.\n")
    finally:
        os._exit(128 + number)


if __name__ == "__main__":
    main()
