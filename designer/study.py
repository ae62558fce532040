"""The whole problem as one frozen value, in SI units."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal

import numpy as np

from designer import checked
from designer.effects.design import AsBuilt, built_with
from designer.effects.effect import Setting
from designer.effects.registry import SHIPPED, KnownEffects
from designer.errors import Fault, InputError, MissingLibraryError
from designer.model.cable import Material, MaterialName, Preference, PriceList, Trust
from designer.model.load_case import EACH, LoadCase
from designer.model.measurements import Measurements
from designer.model.robot import TEMPERATE, Machine, Poses, Robot, Surroundings
from designer.model.uncertainty import Uncertainty
from designer.model.winches import RUNNING_ROPE, SOURCE, DutyClass, RopeLife
from designer.model.workspace import Workspace
from designer.resources import missing_library

_LIKELY_DIAMETER_M = 0.01  # Of the cable that stands in where none is given yet
_FLAT = 1e-6
Objective = Literal["mass", "cost", "drum_diameter", "max_tension", "stiffness"]


@checked.reports_field
@dataclass(frozen=True, slots=True)
class RopeLimits:
    """Limits that the chosen rope is checked against; None asks for nothing.

    Parameters
    ----------
    stiffness_N_per_m : float or None
        Least force per displacement of the platform, in any direction, cables of fixed length
        [N/m].
    excitation_Hz : (float, float) or None
        Band from the lowest to the highest frequency of what shakes the robot [Hz], in which no
        natural frequency of cables and platform shall lie.
    drum_capacity_m : float or None
        Rope that a drum takes up, beside its dead turns [m].
    platform_frequency_Hz : tuple of float or None
        Least natural frequency of the platform, or a band in which none of them shall be [Hz].
    """

    stiffness_N_per_m: checked.Positive | None = None
    excitation_Hz: tuple[float, float] | None = None
    drum_capacity_m: checked.Positive | None = None
    platform_frequency_Hz: tuple[float] | tuple[float, float] | None = None

    def __post_init__(self) -> None:
        checked.check_fields(self)
        for name in ("excitation_Hz", "platform_frequency_Hz"):
            low = 0.0
            for end in getattr(self, name) or ():
                checked.Number(above=low).require(name, end)
                low = end


_SAFETY_FACTOR = 5.0
"""Where a study gives neither a factor nor a duty class."""


@checked.reports_field
@dataclass(frozen=True, slots=True)
class CableGroup:
    """Cables that get the same product: a name, and their numbers from 1."""

    name: str
    cables: tuple[int, ...]

    def __post_init__(self) -> None:
        if not self.cables:
            raise ValueError(f"group '{self.name}' has no cable")
        for cable in self.cables:
            checked.Number(least=1).require(f"a cable of group '{self.name}'", cable)


@checked.reports_field
@dataclass(frozen=True, slots=True)
class Selection:
    """How a product is chosen.

    Parameters
    ----------
    grades : tuple of str or None
        Grade ids to consider; None for every grade in the catalogue.
    safety_factor : float
        What is left of the minimum breaking load over the allowable tension.
    objectives : tuple of str
        What candidates are compared by; the first decides.
    termination_efficiency : float
        Share of the breaking load that the end fittings keep.
    sheave_diameter_m : float or None
        Diameter that the rope is bent over [m]; None leaves bending out.
    groups : tuple of CableGroup
        Groups of cables that may each get a product of their own; empty for none.
    max_distinct_products : int or None
        How many products the groups may have between them; None for one each.
    limits : RopeLimits
        What the chosen rope is checked against beyond its strength.
    duty_class : str
        Mechanism group, which gives the safety factor of running ropes; ``none`` for none.
    rope_life : RopeLife or None
        How many bends ropes bear, and how many they shall.
    price_list : PriceList or None
        Offers that come before the prices of grades.
    trust : str
        The lowest trust of figures that is tried, of grades that the study does not name.
    materials : tuple of str
        Materials to consider; empty for all.
    prefer : str
        Units of the sizes that take the place of others as good as they are.
    """

    grades: tuple[str, ...] | None = None
    safety_factor: checked.Factor = _SAFETY_FACTOR
    objectives: tuple[Objective, ...] = ("mass", "drum_diameter", "max_tension")
    termination_efficiency: checked.Efficiency = 1.0
    sheave_diameter_m: checked.Positive | None = None
    groups: tuple[CableGroup, ...] = ()
    max_distinct_products: checked.Count | None = None
    limits: RopeLimits = field(default_factory=RopeLimits)
    duty_class: DutyClass = "none"
    rope_life: RopeLife | None = None
    price_list: PriceList | None = None
    trust: Trust = "B"
    materials: tuple[MaterialName, ...] = ()
    prefer: Preference = "metric"

    def __post_init__(self) -> None:
        checked.check_fields(self)
        if self.duty_class != "none":
            factor = RUNNING_ROPE[self.duty_class]
            if self.safety_factor not in (_SAFETY_FACTOR, factor):
                given = f"safety_factor {self.safety_factor:g}"
                raise ValueError(f"{given} contradicts duty_class {self.duty_class}")
            object.__setattr__(self, "safety_factor", factor)
        if not self.objectives:
            raise ValueError("objectives must name one at least")
        if isinstance(self.grades, str):
            raise ValueError(f"grades must be several ids, not the text {self.grades!r}")
        if self.max_distinct_products is not None and not self.groups:
            raise ValueError("max_distinct_products has no meaning without groups")
        first: dict[int, str] = {}
        for group in self.groups:
            for cable in group.cables:
                if cable in first:
                    raise ValueError(f"cable {cable} is in group '{first[cable]}' already")
                first[cable] = group.name

    @property
    def factor_source(self) -> str:
        """Where the safety factor is from."""
        if self.duty_class == "none":
            return "S as the study gives it"
        return f"S of duty class {self.duty_class}: {SOURCE}"

    def under(self, case: LoadCase) -> Selection:
        """Return the same with the safety factor and the efficiency of a load case."""
        return replace(
            self,
            safety_factor=case.safety_factor or self.safety_factor,
            duty_class="none" if case.safety_factor else self.duty_class,
            termination_efficiency=case.termination_efficiency or self.termination_efficiency,
        )


@dataclass(frozen=True, slots=True)
class GradeFamily(checked.Value):
    """The grade whose continuous family the optimum is computed in, and the safety factor in it."""

    grade: str
    safety_factor: checked.Factor


@dataclass(frozen=True, slots=True)
class Entry:
    """One value of the config, as written and as understood."""

    field: str  # Path into the document, such as `robot.platform.mass`
    given: str  # What the file says; `default` where it says nothing
    value_SI: str  # The same in SI units, with the unit


@dataclass(frozen=True, slots=True)
class StudySource:
    """Where a study came from."""

    path: Path  # The config file
    sha256: str  # Digest of its bytes
    entries: tuple[Entry, ...]  # Every field, for the report's table of inputs
    # Line of each field that the file gives, by its path
    lines: Mapping[str, int] = field(default_factory=dict, repr=False, hash=False)
    tables: tuple[tuple[str, str], ...] = ()  # Name and digest of each file that it was read with

    def fault(self, field: str, problem: str, expected: str = "") -> Fault:
        """Return a fault at a field of the config file.

        A field that the file leaves out gets the line of the nearest mapping around it.
        """
        nearest = field
        while nearest and nearest not in self.lines:
            nearest = nearest[: max(nearest.rfind("."), nearest.rfind("["), 0)]
        return Fault(str(self.path), self.lines.get(nearest), field, problem, expected)


IN_PYTHON = StudySource(Path("study"), "", ())
"""Of a study that no file describes."""


@dataclass(frozen=True, slots=True)
class DocumentControl:
    """What a drawing office writes on a document; empty where the study does not say."""

    number: str = ""
    revision: str = ""
    author: str = ""
    checker: str = ""
    approver: str = ""
    logo: Path | None = None  # A PNG, JPEG or SVG file


@checked.reports_field
@dataclass(frozen=True, slots=True)
class DeclaredEffect:
    """An effect that the model of this machine has."""

    id: str  # As in `known_effects` of the study
    cable: checked.Count | None  # The one cable that it concerns, from 1; None for all
    # All of its parameters, in the units that their names end in
    parameters: Mapping[str, float] = field(hash=False)

    def __post_init__(self) -> None:
        checked.check_fields(self)
        for name, value in self.parameters.items():
            checked.FINITE.require(name, value)


@checked.reports_field
@dataclass(frozen=True, slots=True, repr=False)
class Study(checked.Shown):
    """A robot, its load, where it works, and how its cable is to be chosen.

    ``material`` is the family that is sized, its allowable stress that at the exit point.
    ``known_effects`` are those that ``effects`` may declare and a diagnosis may find; ``family``
    is the grade that ``material`` stands for, None where the study gives its figures.
    ``session_effects`` are effects of single sessions of the measurements, in their order.
    """

    name: str
    robot: Robot
    material: Material
    source: StudySource = IN_PYTHON
    pose: Poses | None = None
    workspace: Workspace | None = None
    selection: Selection | None = None
    catalogues: tuple[Path, ...] = ()
    measurements: Measurements | None = None
    effects: tuple[DeclaredEffect, ...] = ()
    known_effects: KnownEffects = SHIPPED
    surroundings: Surroundings = TEMPERATE
    family: GradeFamily | None = None
    document: DocumentControl = DocumentControl()
    load_cases: tuple[LoadCase, ...] = ()
    uncertainty: Uncertainty | None = None
    session_effects: tuple[tuple[DeclaredEffect, ...], ...] = ()

    def __post_init__(self) -> None:
        self._check_load_cases()
        if self.pose is not None and self.pose.shape:
            raise ValueError(f"pose must be one pose, not {self.pose.shape} of them")
        if self.selection is not None and self.workspace is None:
            raise ValueError("a selection needs the workspace that the product is to serve")
        groups = self.selection.groups if self.selection else ()
        grouped = {cable for group in groups for cable in group.cables}
        every = set(range(1, self.robot.n_cables + 1))
        if grouped and grouped != every:
            wrong = ", ".join(map(str, sorted(grouped ^ every)))
            raise ValueError(
                f"groups must have every cable from 1 to {len(every)} once; wrong is {wrong}"
            )

    def effects_of_session(self, session: int) -> tuple[DeclaredEffect, ...]:
        """Return what is declared of one session of the measurements alone, from 1."""
        return self.session_effects[session - 1] if self.session_effects else ()

    def _check_load_cases(self) -> None:
        names = [case.name for case in self.load_cases]
        if len({*names}) < len(names):
            raise ValueError(f"two load cases have one name: {names}")
        if names and self.workspace is None:
            raise ValueError("load cases need a workspace")
        if self.selection is not None and names and self.selection.groups:
            raise ValueError("load cases are not for groups of cables")
        if self.uncertainty and (self.selection is None or self.selection.groups):
            raise ValueError("uncertainty needs a selection, without groups")
        self._check_inertia()
        for case in self.load_cases:
            case_factors = case.safety_factor, case.termination_efficiency
            if self.selection is None and case_factors != (None, None):
                raise ValueError(f"'{case.name}' changes a selection that is not there")
            if case.wind is not None and self.robot.platform.drag_area_m2 is None:
                raise ValueError(f"the wind of '{case.name}' needs the drag area of the platform")
            along = None if case.wind is None else case.wind.direction
            if self.robot.is_planar and along is not None:
                off = abs(float(along @ self.robot.level[1])) / float(np.linalg.norm(along))
                if off > _FLAT:
                    raise ValueError(f"the wind of '{case.name}' leaves the plane of the robot")
            lost = case.cable_lost
            if lost not in (None, EACH) and int(lost) > self.robot.n_cables:
                raise ValueError(f"there is no cable {lost} to be lost in '{case.name}'")

    def _check_inertia(self) -> None:
        has_limit = self.selection and self.selection.limits.platform_frequency_Hz
        if not has_limit or self.robot.is_point_mass:
            return
        known = [
            self.robot.platform.inertia_kg_m2,
            *(c.inertia_kg_m2 for c in self.load_cases if c.mass_kg),
        ]
        if any(inertia is None for inertia in known):
            raise ValueError("a limit of the platform's frequencies needs its inertia")

    @property
    def unproved(self) -> Study:
        """The same, of which no proof is tried: it may take its whole budget."""
        if self.workspace is None:
            return self
        return replace(self, workspace=replace(self.workspace, proof_s=0.0))

    @property
    def pose_outside(self) -> str:
        """In what the pose is none of the workspace, as ``lies outside the region``; or empty."""
        if self.pose is None or self.workspace is None:
            return ""
        beyond, beyond_turn = self.workspace.space.outside(self.pose.place)
        is_list = self.workspace.region.is_discrete
        reason = "is none of the listed points" if is_list else "lies outside the region"
        turn = "is turned as the workspace is not"
        return " and ".join(
            [reason] * beyond + [turn] * (beyond_turn and not self.robot.is_point_mass)
        )


def require_enough_cables(study: Study) -> None:
    """Refuse a robot that has fewer cables than degrees of freedom.

    Nothing holds such a robot in a pose that one chooses; measured data may come from any.

    Raises
    ------
    InputError
        With one fault, at the anchors.
    """
    robot = study.robot
    if robot.has_enough_cables:
        return
    load = "a point mass" if robot.is_point_mass else "a platform with attachments"
    problem = (
        f"{robot.n_cables} cables on {load} are fewer than its "
        f"{robot.degrees_of_freedom} degrees of freedom"
    )
    expected = f"{robot.degrees_of_freedom} or more"
    raise InputError([study.source.fault("robot.anchors", problem, expected)])


def require_answerable(study: Study) -> None:
    """Refuse a study that asks for nothing, or a robot that nothing holds in a pose of choice.

    Raises
    ------
    InputError
        With one fault.
    MissingLibraryError
        If ropes for groups of cables are asked for and nothing is installed that chooses them.
    """
    require_enough_cables(study)
    if study.selection is not None and study.selection.groups:
        missing = missing_library("cvxpy")
        if missing:
            place = study.source.fault("selection.groups", missing, "a study without groups")
            raise MissingLibraryError(str(place))
    if study.pose is None and study.workspace is None:
        fault = study.source.fault("", "nothing to solve", "a pose, a workspace or both")
        raise InputError([fault])


def declared_settings(study: Study, machine: Machine | None = None) -> tuple[Setting, ...]:
    """Return the declared effects with their values, in the order in which they act.

    For a machine; the study's robot with a cable of its family, if left out.

    Raises
    ------
    InputError
        If this machine cannot have one of them.
    """
    parameters_of = {(effect.id, effect.cable): effect.parameters for effect in study.effects}
    ids = {effect_id for effect_id, _ in parameters_of}
    known = KnownEffects(tuple(e for e in study.known_effects.effects if e.id in ids))
    settings = tuple(
        Setting(effect, parameters_of[effect.id, effect.cable])
        for effect in known.of(machine or declared_machine(study))
        if (effect.id, effect.cable) in parameters_of
    )
    impossible = parameters_of.keys() - {(s.effect.id, s.effect.cable) for s in settings}
    if impossible:
        raise InputError(
            study.source.fault(f"effects.{effect_id}", "this robot cannot have it")
            for effect_id, _ in sorted(impossible, key=str)
        )
    return settings


def declared_machine(study: Study) -> Machine:
    """Return the robot in its declared surroundings, with a cable of the study's family."""
    cable = study.material.cable(_LIKELY_DIAMETER_M)
    return Machine(study.robot, cable, surroundings=study.surroundings)


def as_built_by(study: Study, section_m: float | None = None, *, mounted: bool = False) -> AsBuilt:
    """Return the robot and its cables as the declared effects have them, and how far they may sag.

    Effects that are properties of a rope (`Effect.of_rope`) belong to the rope that they are of.
    With measurements that is the rope on the machine, which ``mounted`` asks for, and no other rope
    has them; without, it is that of the configured family. A product of the catalogue never has
    them: its data sheet counts. ``section_m`` is the diameter at which effects are applied to a
    family that does not stay one [m].
    """

    def built(*, has_rope_effects: bool) -> AsBuilt:
        def settings_of(machine: Machine) -> tuple[Setting, ...]:
            every = declared_settings(study, machine)
            return tuple(
                setting for setting in every if has_rope_effects or not setting.effect.of_rope
            )

        return built_with(declared_machine(study), settings_of)

    found = built(has_rope_effects=mounted or study.measurements is None)
    product = built(has_rope_effects=False)
    robot = found.robot
    if study.workspace is not None:
        robot = replace(robot, sag_max=study.workspace.sag_max)
    return replace(found, robot=robot, section_m=section_m, change_of_product=product.change)


def rope_effects(study: Study) -> tuple[str, ...]:
    """Return the declared effects that belong to a rope, by their ids."""
    return tuple(
        setting.effect.id for setting in declared_settings(study) if setting.effect.of_rope
    )
