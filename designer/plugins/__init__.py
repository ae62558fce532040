"""The door by which rope grades and physical effects come in, ours as well as anybody's."""

from designer.plugins.hooks import hookimpl

__all__ = ["hookimpl"]
