"""Random studies of three to six options against a reference that shares nothing with our solvers.

    python tests/benchmarks/random_studies.py [--seed 0] [--count 100] [--places 200]

Each study is a base of `tests/pairs/options.py` at random dimensions with options at random. What
its governing places ask for has to be what the reference finds there, to 1e-6, and no place,
direction of wind or inertia at random may ask for more. What does not is told, with the study, and
ends the run with status 1.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1]))

import numpy as np
import yaml
from pairs import options
from pairs.agreement import disagreements
from pairs.options import BASES, OPTIONS, Option
from pairs.table import analysed

from designer.errors import InputError

NOT_DRAWN = ("planar", "cost", "uncertainty", "pose")
"""What changes no governing place, or is compared by the table of pairs alone."""
BOX = options.BY_ID["box"]


def random_study(rng: np.random.Generator) -> tuple[str, list[Option], dict[str, Any]]:
    """Return a base, three to six options that fit it, and the text of the study."""
    base = str(rng.choice(list(BASES), p=[0.35, 0.15, 0.1, 0.2, 0.2]))
    drawn = [o for o in OPTIONS if base in o.bases and not o.is_command and o.id not in NOT_DRAWN]
    count = int(rng.integers(3, 7))
    chosen = [drawn[k] for k in rng.choice(len(drawn), count, replace=False)]
    if rng.random() < 0.5 and BOX not in chosen:
        chosen = [BOX, *chosen[1:]]
    text = _shaken(options.study_of(base, *chosen), rng)
    return base, chosen, text


def _shaken(value: Any, rng: np.random.Generator, path: str = "") -> Any:
    """Return the text with its loads, exit points and masses changed by some percent."""
    if isinstance(value, dict):
        return {name: _shaken(part, rng, f"{path}.{name}") for name, part in value.items()}
    if path == ".robot.anchors":
        level = [1.0, 0.0, 1.0] if all(point[1] == 0.0 for point in value) else [1.0, 1.0, 1.0]
        moves = rng.uniform(-0.3, 0.3, (len(value), 3)) * level
        return (np.array(value) + moves).round(6).tolist()
    scaled = (".mass", ".acceleration", ".speed", ".thickness", ".temperature_change", ".radius_m")
    if path.endswith(scaled) and isinstance(value, float):
        return round(float(value * rng.uniform(0.7, 1.2)), 6)
    return value


def study_of_seed(seed: int, folder: Path, places: int) -> tuple[str, list[str], str]:
    """Return what became of a study, what is wrong with it, and its text."""
    rng = np.random.default_rng(seed)
    base, chosen, text = random_study(rng)
    told = f"# {seed}: {base}, {', '.join(option.id for option in chosen)}\n"
    told += yaml.safe_dump(text, sort_keys=False)
    try:
        analysis = analysed(text, folder)
    except InputError as error:
        return "refused", [line for line in map(str, error.faults) if "\n" in line], told
    if not analysis.assignment.is_found:
        return "no rope", [], told
    wrong = list(disagreements(text, analysis, places, seed))
    return ("different" if wrong else "equal"), wrong, told


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--places", type=int, default=200)
    given = parser.parse_args()
    counts: Counter[str] = Counter()
    with TemporaryDirectory() as folder:
        for seed in range(given.seed, given.seed + given.count):
            kind, wrong, told = study_of_seed(seed, Path(folder), given.places)
            counts[kind] += 1
            if wrong:
                print(told, *(f"# {line}" for line in wrong), sep="\n", flush=True)
    print(", ".join(f"{count} {kind}" for kind, count in sorted(counts.items())))
    sys.exit(1 if counts["different"] else 0)


if __name__ == "__main__":
    main()
