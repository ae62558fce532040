"""Effects, fitted values, chances and readings in words and units; filters of templates."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from designer.arrays import FloatArray, IntArray
from designer.diagnosis.accuracy import Error, Interval, Stage
from designer.diagnosis.calibration import Calibrated
from designer.diagnosis.result import Diagnosis, Estimate, Finding
from designer.diagnosis.search import EffectTrial
from designer.effects.effect import OF_SESSION, Effect, Parameter
from designer.model.measurements import KINDS, Noise
from designer.report import format as fmt
from designer.spelling import in_runs

NO_BREAK = "\u00a0"
_OF_A_CABLE = re.compile(r"(length|tension|direction|speed)_(\d+)(?:_(m|N|m_per_s))?")
_OURS = {
    **{f"{axis}_m": (axis, "m") for axis in "xyz"},
    **{f"wind_{axis}_m_per_s": (f"wind along {axis}", "m/s") for axis in "xyz"},
    "time_s": ("time", "s"),
    "temperature_C": ("temperature", "°C"),
    "speed_m_per_s": ("speed of the platform", "m/s"),
    "row": ("row", ""),
}
_SUFFIX = re.compile(
    r"(.+?)_((?:m|rad|deg)_per_s2?|mm|m|kN|N|kg|ms|s|degC|deg|rad|mV|V|mA|kW|Hz|rpm|bar|kPa|hPa|Pa|"
    r"percent)"
)
"""Not the letters that number sensors as well: A, C, K."""
_SPELT = {"degC": "°C", "deg": "°", "percent": "%"}
_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_NEGLIGIBLE = 1e-12
_TO_95 = 1.96
_CABLE = "the cable is {} than declared"
_PAYLOAD = "the platform with its payload is {} than declared"
_STREAM = "the length stream {} the pose stream"
_DIRECTIONS = {
    "elastic_modulus": ("scale", _CABLE, "stiffer", "softer"),
    "linear_mass": ("scale", _CABLE, "heavier", "lighter"),
    "platform_mass": ("offset_kg", _PAYLOAD, "heavier", "lighter"),
    "clock_offset": ("offset_s", _STREAM, "lags", "runs ahead of"),
}
"""The parameter that tells the direction, and the words for more and for less of it."""
_OF_SEVERAL = {
    "anchor_offset": "the exit points of {} are not where the drawing has them",
    "tension_gain": "the load cells of {} have wrong gains",
}


def plain(effect: Effect, values: Mapping[str, float]) -> str:
    """Return what an effect is, in a few words, with its direction where it has one."""
    if effect.id not in _DIRECTIONS:
        return effect.summary
    name, text, more, less = _DIRECTIONS[effect.id]
    text = text.format(more if values[name] > effect.neutral[name] else less)
    return f"{text} in session {effect.session}" if effect.session else text


def grouped(findings: Iterable[Finding]) -> list[tuple[Finding, ...]]:
    """Return findings with those of one kind drawn together, by cable."""
    kinds: dict[tuple[str, int | None], list[Finding]] = {}
    for finding in findings:
        kinds.setdefault((finding.effect.id, finding.effect.session), []).append(finding)
    return [tuple(sorted(kind, key=lambda f: f.effect.cable or 0)) for kind in kinds.values()]


def plain_group(group: Sequence[Finding]) -> str:
    """Return what was found of one kind, in a few words; how far, where points have moved."""
    first = group[0].effect
    if len(group) == 1 or first.id not in _OF_SEVERAL:
        return fmt.listing(plain_finding(finding) for finding in group)
    text = _OF_SEVERAL[first.id].format(_cables(group))
    text += f" in session {first.session}" if first.session else ""
    if first.id == "anchor_offset":
        moved = [moved_m(finding) for finding in group]
        text += f", by {_short(1e3 * min(moved))} to {_short(1e3 * max(moved))}{NO_BREAK}mm"
    return text


def key_of(group: Sequence[Finding]) -> str:
    """Return id and cables of findings of one kind."""
    first = group[0].effect
    of_session = f"{OF_SESSION}{first.session}" if first.session else ""
    return first.key if len(group) == 1 else f"{first.id} of {_cables(group)}{of_session}"


def moved_m(finding: Finding) -> float:
    """Return how far a point is off [m]."""
    return math.hypot(*(estimate.value for estimate in finding.parameters.values()))


def _cables(group: Sequence[Finding]) -> str:
    return f"cables {fmt.listing(str(finding.effect.cable) for finding in group)}"


def plain_finding(finding: Finding) -> str:
    """Return what was found, in a few words."""
    return plain(finding.effect, {name: e.value for name, e in finding.parameters.items()})


def rival_names(rivals: Iterable[str], last: str = "or") -> str:
    """Return names of rivals as ``a, b or c and d together``."""
    return fmt.listing((f"{name} together" if " and " in name else name for name in rivals), last)


def rivals_of(group: Sequence[Finding]) -> list[str]:
    """Return the rivals of findings of one kind, each once."""
    return [*dict.fromkeys(rival for finding in group for rival in finding.rivals)]


def runs_of_rows(rows: IntArray) -> str:
    """Return rows such as ``12, 45 to 48 and 60``."""
    return fmt.listing(in_runs(rows))


def fitted_values(effect: Effect, estimates: Mapping[str, Estimate]) -> str:
    """Return all fitted values such as ``radius = 119.8 ± 0.4 mm``."""
    shown = (f"{p.label} = {estimate(estimates[p.name], p.unit)}" for p in effect.parameters)
    return ", ".join(text.replace(" ", NO_BREAK) for text in shown)


def trial_values(trial: EffectTrial) -> str:
    """Return the values of the effect that was tried, fitted with those found before."""
    stds = iter(trial.fit.std)  # of all parameters of all settings, in their order
    for setting in trial.fit.settings:
        estimates = {
            name: Estimate(value, float(std))
            for (name, value), std in zip(setting.values.items(), stds, strict=False)
        }
        if setting.effect.key == trial.effect.key:
            return fitted_values(trial.effect, estimates)
    return ""


def covariate(name: str) -> str:
    """Return a covariate in words: ``tension_3_N`` is ``tension of cable 3``.

    A column of the user's own keeps its name.
    """
    return _covariate(name)[0]


def covariate_axis(name: str) -> str:
    """Return a covariate with its unit, where its name tells one."""
    text, unit = _covariate(name)
    if text == name and (found := _SUFFIX.fullmatch(name)):
        text = found[1]
        unit = _SPELT.get(found[2], found[2].replace("deg_per", "°_per").replace("_per_", "/"))
    return f"{text} [{unit}]" if unit else text


def _covariate(name: str) -> tuple[str, str]:
    if name in _OURS:
        return _OURS[name]
    if found := _OF_A_CABLE.fullmatch(name):
        return f"{found[1]} of cable {found[2]}", (found[3] or "").replace("_per_", "/")
    return name, ""


def estimate(item: Estimate | Calibrated | float, unit: str) -> str:
    """Return a value with its standard deviation, if it has one, to two digits of the latter."""
    value, std = (item, math.nan) if isinstance(item, float | int) else (item.value, item.std)
    if unit == "m" and abs(value) < 1.0:
        value, std, unit = 1e3 * value, 1e3 * std, "mm"
    size = max(abs(value), std if math.isfinite(std) else 0.0)
    power = math.floor(math.log10(size)) if size > 0.0 else 0
    power = power if not -4 < power < 6 else 0
    value, std = value / 10.0**power, std / 10.0**power
    text = _with_std(value, std)
    if power:
        text = f"({text}) × 10{str(power).translate(_SUPERSCRIPTS)}"
    return f"{text} {unit}".strip().replace(" ", NO_BREAK)


def interval_95(item: Estimate, unit: str) -> str:
    """Return the 95 % interval of a normal distribution about a value."""
    if not math.isfinite(item.std):
        return fmt.MISSING
    ends = [item.value + sign * _TO_95 * item.std for sign in (-1, 1)]
    return _range(ends, unit, abs(item.value))


def with_interval(error: Interval, scale: float) -> str:
    """Return an error with its interval, such as ``3.21 (2.9 to 3.6)``."""
    value, low, high = (fmt.number(scale * x, 3) for x in (error.value, error.low, error.high))
    return f"{value} ({low} to {high})"


def plausible_range(parameter: Parameter) -> str:
    """Return the range that an engineer would believe."""
    return _range(parameter.plausible, parameter.unit, max(map(abs, parameter.plausible)))


def _range(ends: Iterable[float], unit: str, size: float) -> str:
    """Return two ends with their unit, in millimetres where they are of a size below a metre."""
    scale, unit = (1e3, "mm") if unit == "m" and size < 1.0 else (1.0, unit)
    shown = " to ".join(_short(scale * end) for end in ends)
    return f"{shown} {unit}".strip().replace(" ", NO_BREAK)


def chance(value: float) -> str:
    """Return a probability such as ``0.3 %`` or ``below 10⁻¹²``."""
    if math.isnan(value):
        return fmt.MISSING
    if value < _NEGLIGIBLE:
        return "below 10⁻¹²"
    return fmt.power_of_ten(value) if value < 1e-4 else fmt.percent(value, 2)


def _with_std(value: float, std: float) -> str:
    if not math.isfinite(std) or std <= 0.0:
        return fmt.number(value)
    places = min(max(1 - math.floor(math.log10(std)), 0), 9)
    return f"{fmt.fixed(value, places)} ± {fmt.fixed(std, places)}"


def _short(value: float) -> str:
    is_plain = value == 0.0 or 1e-3 <= abs(value) < 1e7
    return fmt.trimmed(value, 3) if is_plain else fmt.power_of_ten(value)


# The two kinds of readings, and how the report shows them.


@dataclass(frozen=True, slots=True)
class ReadingKind:
    """A kind of reading: ``length`` or ``tension``, its unit in the report, the scale from SI.

    ``noise`` is the standard deviation of one reading in SI units.
    """

    name: str
    unit: str
    scale: float
    noise: float

    @property
    def field(self) -> str:
        """What results call it."""
        return "length_m" if self.name == "length" else "tension_N"

    def error_of(self, stage: Stage) -> Error | None:
        """Return its error at a stage; None where it was not measured."""
        return stage.length_m if self.name == "length" else stage.tension_N

    def errors_of(self, stages: Iterable[Stage]) -> Iterator[tuple[str, Error]]:
        """Yield label and error of each stage that has one."""
        for stage in stages:
            error = self.error_of(stage)
            if error is not None:
                yield stage.label, error

    def shown(self, value: float) -> str:
        """Return a value in SI units as text, without its unit."""
        return fmt.number(self.scale * value, 3)

    def all_shown(self, values: FloatArray) -> list[str]:
        """Return values in SI units as texts, without their unit."""
        return [self.shown(float(value)) for value in values]

    def with_unit(self, value: float) -> str:
        """Return a value in SI units as text."""
        return f"{self.shown(value)}\u00a0{self.unit}"

    def interval(self, found: Interval) -> str:
        """Return the ends of an interval in SI units as text, without unit."""
        return f"{self.shown(found.low)} to {self.shown(found.high)}"

    def in_noise(self, value: float) -> str:
        """Return a value in units of noise."""
        ratio = value / self.noise
        return fmt.number(ratio, 2 if ratio < 10.0 else 3)


def kinds(noise: Noise) -> tuple[ReadingKind, ReadingKind]:
    """Return lengths and tensions, measured or not."""
    length, tension = (ReadingKind(x.name, x.unit, x.scale, x.of(noise)) for x in KINDS)
    return length, tension


def quantities(diagnosis: Diagnosis) -> Iterator[tuple[ReadingKind, Error, Error]]:
    """Yield each kind that was measured, with its error before and after."""
    of_name = {quantity.name: quantity for quantity in kinds(diagnosis.noise)}
    return ((of_name[kind.name], before, after) for kind, before, after in diagnosis.errors)
