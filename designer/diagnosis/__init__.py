"""Measured data against the model: residual, missing effect, error before and after.

The hooks are those of the ring, which reads tables of measured data in `designer/measured`.
"""

from __future__ import annotations

from collections.abc import Callable

from designer.plugins import hookimpl


@hookimpl
def register_commands() -> list[Callable[..., object]]:
    """Return `designer diagnose`."""
    from designer.diagnosis.command import diagnose

    return [diagnose]


@hookimpl
def register_template_filters() -> list[Callable[..., object]]:
    """Return what pages say values, effects and readings with."""
    from designer.diagnosis import words
    from designer.report.templates import public_functions

    return public_functions(words)
