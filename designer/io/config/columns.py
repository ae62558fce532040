"""The map from a log's own columns to ours."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BeforeValidator, model_validator

from designer.documents.fields import Text, bounded, mapping, refusal
from designer.documents.section import Section, config_field
from designer.measured.assign import COVARIATE, IGNORE, column_hint, dimension_of
from designer.units import (
    NUMBER,
    TEMPERATURE,
    Dimension,
    QuantityError,
    describe,
    read_quantity,
    unit_conversion,
)

_TARGET = f"a column of ours such as 'length_1_m', or '{IGNORE}', or '{COVARIATE}'"


def _target(value: object) -> str:
    if not isinstance(value, str):
        raise refusal(f"{describe(value)} is not a name", _TARGET)
    if value not in (IGNORE, COVARIATE) and dimension_of(value) is None:
        raise refusal(f"{describe(value)} is no column of ours", _TARGET + column_hint(value))
    return value


class ColumnSection(Section):
    """What one column of a log is to us, and in which unit.

    The value is the reading in its unit, or ``scale`` · reading, plus ``offset``.
    """

    to: Annotated[str, BeforeValidator(_target)] = config_field(expected=_TARGET)
    """Our name, such as length_1_m; ignore; or covariate."""
    unit: Text | None = None
    """Unit of the readings."""
    scale: Annotated[float, bounded("scale of a column")] | None = None
    """Factor from the readings to ours; instead of a unit."""
    offset: Any = None
    """What is added after that, as a quantity."""

    @model_validator(mode="before")
    @classmethod
    def _from_name(cls, value: object) -> object:
        if not isinstance(value, str | dict):
            expected = f"{_TARGET}, or {{to: …, unit: …}}"
            raise refusal(f"{describe(value)} is not a name", expected)
        return {"to": value} if isinstance(value, str) else value

    @model_validator(mode="after")
    def _check_conversion(self) -> ColumnSection:
        self.conversion()
        return self

    def conversion(self) -> tuple[float, float]:
        """Return scale and offset from the log's numbers to ours."""
        dimension = dimension_of(self.to)
        if dimension is None:
            fields_set = self.model_fields_set - {"to"}
            if fields_set:
                raise refusal(f"'{self.to}' takes no {sorted(fields_set)[0]}", f"'{self.to}' alone")
            return 1.0, 0.0
        scale, offset = self._scale(dimension)
        return scale, offset + self._offset(dimension)

    @property
    def meaning(self) -> str:
        """What becomes of a reading, for the table of inputs."""
        scale, offset = self.conversion()
        if (scale, offset) == (1.0, 0.0):
            return self.to
        shift = f" {'-' if offset < 0 else '+'} {abs(offset):.10g}" if offset else ""
        return f"{self.to} = {scale:.10g} · reading{shift}"

    def _scale(self, dimension: Dimension) -> tuple[float, float]:
        if self.scale is not None and self.unit is not None:
            raise refusal("both a unit and a scale are given", "one of the two")
        if self.scale == 0.0:
            raise refusal("the scale is zero", "a factor from the log's numbers to ours")
        if self.unit is None:
            return 1.0 if self.scale is None else self.scale, 0.0
        try:
            return unit_conversion(self.unit, dimension)
        except QuantityError as error:
            _, mark, hint = error.expected.partition("; did you mean")
            expected = f"a unit as in '{dimension.example}'" if dimension.unit else "none"
            problem = f"{describe(self.unit)} is no unit of {dimension.noun}"
            raise refusal(problem, f"{expected}{mark}{hint}") from None

    def _offset(self, dimension: Dimension) -> float:
        # '5 K' as a difference is not 5 K as a temperature
        kind = NUMBER if dimension == TEMPERATURE else dimension
        try:
            return 0.0 if self.offset is None else read_quantity(self.offset, kind)
        except QuantityError as error:
            raise refusal(f"the offset {error.problem}", error.expected) from None


Columns = Annotated[dict[str, ColumnSection], BeforeValidator(mapping)]
