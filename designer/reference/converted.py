"""Published robots that were converted by `designer import` and sized: facts, made once.

The files are their authors' and not shipped: CASPR's are in github.com/darwinlau/CASPR below
``data/model_config/models``, those of WireX below ``config/robots`` of its sources. What a file
leaves out was given as: 25 kg, centre of mass at the origin of the platform's frame, a pose in the
middle of the frame, and galvanised 7x19 wire rope with a safety factor of 5.
"""

from __future__ import annotations

from dataclasses import dataclass

from designer.model.verdict import Verdict

CASPR, WIREX = "CASPR", "WireX"


@dataclass(frozen=True, slots=True)
class Converted:
    """One robot.

    Parameters
    ----------
    name, source : str
        The model, with its set of cables if not the default, and the program it is of.
    n_cables : int
        Cables.
    gaps : tuple of str
        What the file leaves out.
    verdict : Verdict or None
        Of the pose; None where the robot is not sized.
    diameter_mm, tension_N : float or None
        Thinnest cable of the pose, and its largest tension.
    reason : str
        Why it is not sized.
    """

    name: str
    source: str
    n_cables: int
    gaps: tuple[str, ...] = ()
    verdict: Verdict | None = None
    diameter_mm: float | None = None
    tension_N: float | None = None
    reason: str = ""


_SOLVED, _OUTSIDE = Verdict.SOLVED, Verdict.OUTSIDE_HULL
_ROPE = ("rope",)
_ALL = ("mass", "centre of mass", "rope", "pose")

ROBOTS = (
    Converted("ACROBOT", CASPR, 8, _ROPE, _SOLVED, 0.1220, 2.34644),
    Converted("CAROCA", CASPR, 8, _ROPE, _SOLVED, 1.4616, 336.520),
    Converted("CAROCA, with_rotating_pulleys", CASPR, 8, _ROPE, _SOLVED, 1.4431, 328.063),
    Converted("CAROCA, gazebo_sim", CASPR, 8, _ROPE, _SOLVED, 1.5092, 358.801),
    Converted("CoGiRo", CASPR, 8, _ROPE, _SOLVED, 1.5525, 379.680),
    Converted("FAST", CASPR, 6, _ROPE, _SOLVED, 26.4961, 110587),
    Converted("IPAnema_1", CASPR, 8, _ROPE, _SOLVED, 1.0101, 160.719),
    Converted("IPAnema_2", CASPR, 8, _ROPE, _SOLVED, 0.6517, 66.8988),
    Converted("KNTU_planar", CASPR, 4, reason="moves in a plane that lies flat"),
    Converted("MACARM", CASPR, 8, _ROPE, _SOLVED, 0.1555, 3.81109),
    Converted("NIST_RoboCrane", CASPR, 6, _ROPE, _SOLVED, 0.1549, 3.78063),
    Converted("PoCaBot_spatial", CASPR, 4, reason="four cables in one plane for a free platform"),
    Converted("PoCaBot_spatial, dualcables", CASPR, 8, _ROPE, _OUTSIDE),
    Converted("SEGESTA", CASPR, 10, _ROPE, _SOLVED, 0.0527, 0.438094),
    Converted("SpiderBot_UR3", CASPR, 8, reason="several links that move against each other"),
    Converted("Swinburne", CASPR, 8, _ROPE, _SOLVED, 0.4312, 29.2867),
    Converted("Swinburne, full_constrainted", CASPR, 8, _ROPE, _SOLVED, 0.5868, 54.2471),
    Converted("The_Cable_Robot_Simulator", CASPR, 8, _ROPE, _SOLVED, 4.0028, 2523.90),
    Converted("2DIPAnema2", WIREX, 4, _ALL, reason="four cables for six degrees of freedom"),
    Converted("CableMasterRobot", WIREX, 7, _ALL, _OUTSIDE),
    Converted("COPacabana_Handling", WIREX, 8, _ALL, _SOLVED, 0.7864, 97.4155),
    Converted("CoGiRo", WIREX, 8, _ALL, _SOLVED, 0.8152, 104.674),
    Converted("EndlessZ-PaperIAK2013", WIREX, 9, _ALL, _SOLVED, 1.0643, 178.425),
    Converted(
        "EXPO2015_Lucia", WIREX, 8, ("centre of mass", "safety factor", "pose"), _SOLVED, 4.1326,
        381.641,
    ),
    Converted("IPAnema", WIREX, 8, _ALL, _SOLVED, 1.0101, 160.719),
    Converted("IPAnema2", WIREX, 8, _ALL, _SOLVED, 0.9083, 129.960),
    Converted("MACARM", WIREX, 8, _ALL, _SOLVED, 0.7584, 90.5992),
    Converted("Segesta", WIREX, 8, _ALL, _OUTSIDE),
    Converted("WDPSS", WIREX, 8, _ALL, _SOLVED, 0.9211, 133.643),
)  # fmt: skip
