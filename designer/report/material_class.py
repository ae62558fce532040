"""What a rope bears its load with, in the three classes that a reviewer tells apart."""

from __future__ import annotations

from typing import Literal

from designer.grades.grade import Grade

MaterialClass = Literal["steel", "stainless steel", "fibre", "not stated"]

CLASSES: tuple[MaterialClass, ...] = ("steel", "stainless steel", "fibre", "not stated")
"""All classes, in the order of a legend."""


def class_of(grade: Grade) -> MaterialClass:
    """Return the class of a grade's material."""
    if grade.material is None or grade.material == "other":
        return "not stated"
    if grade.material in ("steel", "stainless steel"):
        return grade.material
    return "fibre"
