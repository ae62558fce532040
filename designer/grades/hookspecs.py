"""The marker of a plugin's hooks, under its former name; see `designer.plugins.hookspecs`."""

from designer.plugins.hookspecs import hookimpl

__all__ = ["hookimpl"]
