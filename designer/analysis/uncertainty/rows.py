"""Draws with moved exit points, of a point mass on as few cables as hold it, all in one batch.

Geometry s times as large, on ropes with 1/s of the weight over stiffness, has the same angles and
strains again, with s times the tension over weight. So each draw is put to the scale at which its
rope has the stated weight over stiffness, and is one more pose for a solver that knows one rope.
"""

from __future__ import annotations

import numpy as np

from designer.analysis.uncertainty.draws import Draws
from designer.arrays import FloatArray
from designer.kernel.calling import plain
from designer.model.load_case import Loaded
from designer.model.robot import Poses
from designer.model.verdict import Verdict
from designer.statics.geometry import upright_situation


def utilisation_of_rows(
    loaded: Loaded, places: FloatArray, draws: Draws, ropes: FloatArray
) -> FloatArray:
    """Return largest over allowable tension (n_draws, n_places); NaN where no solution was found.

    Parameters
    ----------
    loaded : Loaded
        A load case without wind on a robot that `has_one_branch`.
    places : array (n_places, n_coordinates)
        Where [m].
    draws : Draws
        Of which payload and exit points count here.
    ropes : array (n_draws, 3)
        Mass per length, ice included [kg/m], EA and allowable tension [N] as drawn.
    """
    from designer.kernel.batch import solve_batch

    robot, cable, count = loaded.robot, loaded.cable, len(places)
    density, stiffness, allowable = ropes.T
    stated = cable.linear_density_kg_per_m / cable.axial_stiffness_N
    scale = density / stiffness / stated
    force = scale * cable.linear_density_kg_per_m / density  # on the stated rope over the drawn one
    exits = (robot.exit_points_m + draws.exit_points_m) @ robot.upright.T
    at = (scale[:, None, None] * places[:, :3]).reshape(-1, 3)
    every = np.repeat(scale[:, None, None] * exits, count, axis=0)
    situation = upright_situation(robot, Poses.at(at), every)
    load = np.repeat(draws.payload * force, count)[:, None] * robot.loads_N()
    weight, ones = cable.weight_N_per_m, np.ones(robot.n_cables)
    solution = solve_batch(
        robot,
        situation._replace(load=plain(load)),
        weight / cable.axial_stiffness_N * ones,
        ones,
        cable.allowable_tension_N / weight * ones,
        1.0 / weight,
        sag_max=robot.sag_max,
    )
    solved = solution.verdict == Verdict.SOLVED
    used = np.where(solved, solution.load_factor, np.nan).reshape(len(draws), count)
    return np.asarray(used * (cable.allowable_tension_N / allowable / force)[:, None])
