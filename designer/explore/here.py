"""The pose that the platform is in: every cable, the verdict, the diameter needed, stability."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from designer.analysis.governing import PlatformModes, modes_at
from designer.analysis.maps import cable_curves_m, chords_m
from designer.arrays import FloatArray
from designer.explore.question import Question, Rope, RopePerCable, cables_words
from designer.model.cable import STANDARD_GRAVITY_M_PER_S2, Cable, Cables
from designer.model.load_case import STATIC
from designer.model.verdict import Verdict
from designer.sizing.newton import size_poses
from designer.statics.inverse import Statics, exit_angle_rad, sag_m, solve_sagging, stretch_m
from designer.statics.rest import resting_places
from designer.statics.stiffness import largest_displacement_m_per_N


@dataclass(frozen=True, slots=True)
class CableHere:
    """One cable in this pose.

    Parameters
    ----------
    number : int
        From 1, in the order of the anchors.
    length_m, chord_m : float
        Unstrained, from the exit point, around the pulley where there is one; and straight [m].
    exit_tension_N, platform_tension_N : float
        Tension at either end [N].
    angle_rad : float
        How far below the horizontal it leaves its exit point [rad].
    sag_m, stretch_m : float
        How far it strays from the line between its ends, and how much its load stretches it [m].
    utilisation : float
        Largest tension anywhere in it over the allowable one.
    hangs_below : bool
        Whether it hangs below the platform.
    """

    number: int
    length_m: float
    chord_m: float
    exit_tension_N: float
    platform_tension_N: float
    angle_rad: float
    sag_m: float
    stretch_m: float
    utilisation: float
    hangs_below: bool


@dataclass(frozen=True, slots=True, eq=False)
class Here:
    """What is known of one pose.

    Parameters
    ----------
    verdict : Verdict
        What became of it, with the rope or, without one, with the thinnest cable.
    rope : Rope, RopePerCable or None
        What the cables are of; None for the thinnest cable that holds the pose.
    cables : tuple of CableHere
        Empty unless solved.
    curves_m : array (n_cables, 81, 3) or None
        Their true shape, from the exit points to the platform [m]; None unless solved.
    chords_m : array (n_cables, 2, 3)
        Straight lines from exit points to attachments [m], solved or not.
    diameter_m : float
        The thinnest cable of the configured family that holds this pose [m]; NaN for none.
    max_tension_N, utilisation : float
        Largest in any cable [N], and over the allowable tension; NaN unless solved.
    stiffness_N_per_m : float
        Smallest force over displacement; zero where the platform would not stay, NaN unless solved.
    is_stable : bool or None
        Whether the platform stays; None unless solved.
    stability : str
        The same in a sentence; empty unless solved.
    caution : str
        What else a reader must know; or empty.
    outside : str
        In what the pose is none of the workspace; or empty.
    statics : Statics
        The equilibrium, if it is solved.
    """

    verdict: Verdict
    rope: Rope | RopePerCable | None
    cables: tuple[CableHere, ...]
    curves_m: FloatArray | None
    chords_m: FloatArray
    diameter_m: float
    max_tension_N: float
    utilisation: float
    stiffness_N_per_m: float
    is_stable: bool | None
    stability: str
    caution: str
    outside: str
    statics: Statics

    @property
    def is_solved(self) -> bool:
        """Whether cables hold the platform here."""
        return self.verdict is Verdict.SOLVED

    @property
    def modes(self) -> PlatformModes | None:
        """How the platform oscillates, winches braked; None unless solved, or of no known inertia.

        Computed when it is asked for, since it takes as long as half of the rest.
        """
        density = self.statics.weight_N_per_m / STANDARD_GRAVITY_M_PER_S2
        body = self.statics.robot.platform
        return modes_at(self.statics, body, density, cables_words(self.rope), STATIC.name)

    @property
    def is_too_weak(self) -> bool:
        """Whether the chosen rope is in balance here and beyond its allowable tension."""
        return self.is_solved and self.rope is not None and self.utilisation > 1.0

    @property
    def sentence(self) -> str:
        """The verdict for the reader; of a rope that is too weak here, that."""
        if self.is_too_weak:
            return (
                "The cables are in balance, but the rope is too weak here: its largest tension is "
                f"{100.0 * self.utilisation:.4g} % of the allowable one."
            )
        return self.verdict.sentence

    def curves_exaggerated_m(self, factor: float) -> FloatArray | None:
        """Return the shapes with their distance from the chords times a factor, None unless solved.

        For the eye alone. Each point is compared with the point of the chord at the same share of
        the length.
        """
        if self.curves_m is None:
            return None
        ends = self.curves_m[:, [0, -1]]
        share = np.linspace(0.0, 1.0, self.curves_m.shape[1])[:, None]
        straight = ends[:, :1] + share * (ends[:, 1:] - ends[:, :1])
        return np.asarray(straight + factor * (self.curves_m - straight))


def here(question: Question, *, settled: bool = False) -> Here:
    """Solve the pose of a question.

    Where it has ``settled``, it is also searched for other places where the platform could rest on
    the same lengths, which takes longer.
    """
    robot, pose, rope = question.robot, question.pose, question.cable
    sizing = size_poses(robot, pose, question.material)
    statics, cable = sizing.statics, rope
    if rope is not None:
        statics = solve_sagging(robot, pose, rope)
    elif statics.is_solved:
        cable = question.material.cable(float(sizing.diameter_m))
    verdict = Verdict(int(statics.verdict))
    stays, stability, stiffness = _stability(question, statics, cable, settled)
    allowable = np.nan if cable is None else cable.allowable_tension_N
    utilisation = np.asarray(statics.cable_tension_N / allowable)
    return Here(
        verdict=verdict,
        rope=question.rope,
        cables=_cables(statics, utilisation) if verdict is Verdict.SOLVED else (),
        curves_m=cable_curves_m(statics) if verdict is Verdict.SOLVED else None,
        chords_m=chords_m(statics),
        diameter_m=float(sizing.diameter_m),
        max_tension_N=float(statics.largest_tension_N),
        utilisation=float(utilisation.max()),
        stiffness_N_per_m=stiffness,
        is_stable=stays,
        stability=stability,
        caution=_caution(question, statics),
        outside=question.outside,
        statics=statics,
    )


def _cables(statics: Statics, utilisation: FloatArray) -> tuple[CableHere, ...]:
    figures = {
        "length_m": statics.length_m,
        "chord_m": statics.geometry().chord_m,
        "exit_tension_N": statics.exit_tension_N,
        "platform_tension_N": statics.platform_tension_N,
        "angle_rad": exit_angle_rad(statics),
        "sag_m": sag_m(statics),
        "stretch_m": stretch_m(statics),
        "utilisation": utilisation,
    }
    return tuple(
        CableHere(
            number=k + 1,
            hangs_below=bool(hangs),
            **{name: float(values[k]) for name, values in figures.items()},
        )
        for k, hangs in enumerate(statics.hanging_cables)
    )


def _stability(
    question: Question, statics: Statics, cable: Cable | Cables | None, settled: bool
) -> tuple[bool | None, str, float]:
    """Return whether the platform stays, in a sentence, and the stiffness."""
    if not statics.is_solved or cable is None:
        return None, "", np.nan
    softness = float(largest_displacement_m_per_N(statics))
    stays = bool(np.isfinite(softness))  # it is NaN where the balance is not stable
    stiffness = 1.0 / softness if stays else 0.0
    if settled:
        rest = resting_places(question.robot, question.pose, cable, statics.length_m)
        return rest.is_stable, rest.sentence, stiffness
    words = "The platform rests here." if stays else "The platform would not stay here."
    return stays, words, stiffness


def _caution(question: Question, statics: Statics) -> str:
    sentences = []
    if question.study.load_cases:
        sentences.append("At rest, without the load cases of the study.")
    if statics.is_solved and statics.hangs_below:
        numbers = [str(k + 1) for k in np.flatnonzero(statics.hanging_cables)]
        hang = "s " + ", ".join(numbers) + " hang" if len(numbers) > 1 else f" {numbers[0]} hangs"
        sentences.append(f"Cable{hang} below the platform.")
    return " ".join(sentences)
