"""Reads the config file: YAML in, a checked and frozen `designer.study.Study` in SI out."""

from designer.io.config.reader import read_study

__all__ = ["read_study"]
