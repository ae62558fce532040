"""The diagnosis report: what it says of data with a known effect, with none, and with a drift."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Callable
from html import unescape
from pathlib import Path

import numpy as np
import pytest
from report_parts import diagnosis_page, said, table, tables, texts, tree

from designer.analysis.provenance import Provenance
from designer.arrays import frozen_array
from designer.diagnosis.case import case_of
from designer.diagnosis.diagnose import diagnose
from designer.diagnosis.plan import Proposal
from designer.diagnosis.problem import Predictor
from designer.diagnosis.report import diagnosis_report, write_diagnosis
from designer.diagnosis.result import (
    MOST_SCATTER,
    Diagnosis,
    Estimate,
    Finding,
    RejectedEffect,
    RopeChoice,
    Use,
)
from designer.diagnosis.statistics import SIGNIFICANCE
from designer.effects.effect import Setting
from designer.effects.registry import SHIPPED
from designer.io.config import read_study
from designer.measured.read import read_measured
from designer.report.document import Report
from designer.report.render import render_html

pytestmark = pytest.mark.slow

CONFIG = """
name: {name}
robot:
  anchors: [[0, 0, 12], [30, 0, 12.5], [14, 26, 11.5]]
  platform: {{mass: 180 kg}}
cable: {{density: 7800 kg/m^3, youngs_modulus: 200 GPa, allowable_stress: 180 MPa}}
pose: [14.5, 10, 5]
measurements:
  file: measured.csv
  cable: {{linear_mass: 0.142 kg/m, axial_stiffness: 3.3 MN}}
  noise: {{length: 1 mm, tension: 4 N}}
"""
COLUMN = "load <b>&$x_{"
HEAD = (
    "time_s,x_m,y_m,z_m,length_1_m,length_2_m,length_3_m,"
    f"tension_1_N,tension_2_N,tension_3_N,{COLUMN}"
)
N_ROWS = 60
RADIUS_M = 0.12


def diagnosed(folder: Path, kind: str, name: str) -> Diagnosis:
    """Diagnose synthetic readings: with pulleys, with nothing, or with a drift of tensions."""
    rng = np.random.default_rng(3)
    position = rng.uniform([9, 5, 2], [20, 15, 8], size=(N_ROWS, 3))
    time = np.linspace(0.0, 6000.0, N_ROWS)
    extra = rng.normal(size=N_ROWS)

    def write(length: np.ndarray, tension: np.ndarray) -> None:
        table = np.column_stack([time, position, length, tension, extra])
        text = "\n".join(",".join(f"{x:.6f}" for x in row) for row in table)
        (folder / "measured.csv").write_text(f"{HEAD}\n{text}\n", encoding="utf-8")

    config = folder / "study.yaml"
    config.write_text(CONFIG.format(name=name), encoding="utf-8")
    study = read_study(config)
    assert study.measurements is not None
    write(np.full((N_ROWS, 3), 20.0), np.full((N_ROWS, 3), 1000.0))
    case = case_of(study, study.measurements, read_measured(study))
    pulley = next(e for e in SHIPPED.of(case.machine) if e.id == "pulley_radius")
    settings = [Setting(pulley, {"radius_m": RADIUS_M})] if kind == "pulley" else []
    readings = Predictor(case.machine, case.measured)(settings)
    tension = readings.tension_N + rng.normal(scale=4.0, size=(N_ROWS, 3))
    if kind == "drift":
        wave = np.sin(2 * np.pi * time / 6000.0)[:, None]
        tension = tension + 12.0 * wave * np.array([1.0, -1.0, 1.0])
    write(readings.length_m + rng.normal(scale=1e-3, size=(N_ROWS, 3)), tension)
    return diagnose(case_of(study, study.measurements, read_measured(study)))


@pytest.fixture(scope="module")
def diagnoses(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Diagnosis]:
    return {
        kind: diagnosed(tmp_path_factory.mktemp(kind), kind, name)
        for kind, name in (
            ("pulley", "Crane"),
            ("nothing", "'<b>A</b> & <script>alert(1)</script>'"),
            ("drift", "Crane"),
        )
    }


def report_of(diagnosis: Diagnosis) -> Report:
    return diagnosis_report(diagnosis, Provenance.now())


@pytest.fixture(scope="module")
def pages(diagnoses: dict[str, Diagnosis]) -> Callable[[str], str]:
    made = {kind: render_html(report_of(d)) for kind, d in diagnoses.items()}
    return made.__getitem__


def visible(html: str) -> str:
    """The page's text without styles and drawings."""
    bare = re.sub(r"<style>.*?</style>|<svg.*?</svg>", " ", html, flags=re.DOTALL)
    return " ".join(re.sub(r"<[^>]+>", " ", bare).replace("\xa0", " ").split())


def test_a_found_effect_is_named_with_its_value(diagnoses: dict[str, Diagnosis]) -> None:
    page = diagnosis_page(report_of(diagnoses["pulley"]))
    assert page.verdict.title == "Found"
    assert "pulleys" in page.verdict.text
    value, std = re.search(r"([\d.]+)\s±\s([\d.]+)", page.findings[0].text).groups()  # type: ignore[union-attr]
    assert abs(float(value) - 1e3 * RADIUS_M) < 4.0 * float(std) < 4.0
    before, after = (float(page.errors.groups[0].rows[0].cells[k]) for k in (1, 3))
    assert before > 50.0
    assert after < 1.3


def test_scatter_is_told_where_it_is_more_than_the_noise(
    diagnoses: dict[str, Diagnosis], pages: Callable[[str], str]
) -> None:
    for kind, diagnosis in diagnoses.items():
        is_larger = max(diagnosis.scatter.values()) > MOST_SCATTER
        assert ("what is left is up to" in visible(pages(kind))) == is_larger, kind


def test_effects_are_shown_as_written(diagnoses: dict[str, Diagnosis]) -> None:
    section = tree(report_of(diagnoses["pulley"]).section("design"), "diagnosis")
    assert "study.diagnosed.yaml" in section.text()
    (effects,) = section.all("pre", "listing")
    assert re.fullmatch(r"effects:\n  pulley_radius:\n    radius_m: 0\.1[12]\d+\n", effects.inner)


def test_nothing_to_find_says_so(
    diagnoses: dict[str, Diagnosis], pages: Callable[[str], str]
) -> None:
    report = report_of(diagnoses["nothing"])
    page = diagnosis_page(report)
    assert page.verdict.title == "Nothing to find"
    assert {"found", "unexplained"}.isdisjoint(section.id for section in report.sections)
    assert "Before" not in [column.title for column in page.errors.columns]
    assert "holds no effects" in visible(pages("nothing"))


def test_what_is_unexplained_names_its_carrier(pages: Callable[[str], str]) -> None:
    text = visible(pages("drift"))
    assert "Unexplained. The residual goes with time," in text
    assert "An empirical correction: no physics, not used in the design" in text
    assert "What is unexplained" in text


@pytest.mark.parametrize("kind", ["pulley", "nothing", "drift"])
def test_ids_are_unique_and_links_lead_somewhere(kind: str, pages: Callable[[str], str]) -> None:
    html = pages(kind)
    ids = re.findall(r'\bid="([^"]+)"', html)
    assert len(ids) == len(set(ids))
    assert set(re.findall(r'href="#([^"]+)"', html)) <= set(ids)


def test_text_of_the_user_is_escaped(pages: Callable[[str], str]) -> None:
    assert "<script>alert" not in pages("nothing")
    assert "load <b>" not in pages("nothing")
    assert "load &lt;b&gt;" in pages("nothing")


def test_rivals_warnings_and_proposals_are_shown(diagnoses: dict[str, Diagnosis]) -> None:
    found = diagnoses["pulley"]
    finding = dataclasses.replace(
        found.findings[0], rivals=("drum_scale",), warnings=("radius_m = 9 m is outside",)
    )
    positions = np.array([[9.0, 5.0, 2.0], [1.0, 5.0, 2.0], [1.0, 1.0, 2.0]])
    separation = np.array([41.5, 0.8, 0.0])
    proposal = Proposal("pulley_radius", "drum_scale", positions, separation)
    doubtful = dataclasses.replace(
        found,
        findings=(finding,),
        proposals=(proposal,),
        withdrawn=(RejectedEffect("creep", "time_s", 0.4),),
    )
    report = report_of(doubtful)
    assert diagnosis_page(report).verdict.tone == "doubt"
    text = visible(render_html(report))
    assert "cannot tell pulley_radius from drum_scale. Poses that would are proposed below" in text
    alike = dataclasses.replace(proposal, separation=0.001 * separation)
    vain = report_of(dataclasses.replace(doubtful, proposals=(alike,)))
    assert "would not either in 1000 measurements" in visible(render_html(vain))
    assert "(9.00, 5.00, 2.00) m 41.5 1" in text
    assert "(1.00, 5.00, 2.00) m 0.800 15" in text  # 14.1 measurements
    assert "(1.00, 1.00, 2.00) m 0 over 1000" in text
    assert "radius_m = 9 m is outside" in text
    assert (
        "creep withdrawn. It fits as a constant, but would have to change with time by 40 %" in text
    )


def test_design_says_what_changes_and_what_does_not_reach_it(
    diagnoses: dict[str, Diagnosis],
) -> None:
    before = RopeChoice("grade", "5 mm", 0.005, 3500.0, 0.0050, 3520.0, 0.923)
    after = RopeChoice("grade", "6 mm", 0.006, 3640.0, 0.0055, 3872.0, 0.881)
    changed = dataclasses.replace(
        diagnoses["pulley"], design_before=before, design_after=after, kept=Use(3640.0, 1.04)
    )
    sentence, numbers = diagnosis_page(report_of(changed)).design
    assert sentence == "The choice changes from grade, 5 mm to grade, 6 mm."
    assert "Its utilisation is 88.1 %." in numbers
    assert "The one chosen before would be used to 104.0 %." in numbers
    assert "(+4.0 %)" in numbers
    assert "no minimum_breaking_load" in numbers
    same = dataclasses.replace(before, max_tension_N=3710.0, utilisation=0.979)
    stays = dataclasses.replace(
        diagnoses["pulley"], design_before=before, design_after=same,
        mounted_before=Use(3500.0, 0.96), mounted_after=Use(3710.0, 1.02),
    )  # fmt: skip
    text = visible(render_html(report_of(stays)))
    assert "Its utilisation goes from 92.3 % to 97.9 %." in text
    assert "The utilisation of the rope on the machine goes from 96.0 % to 102.0 %." in text
    assert "That rope is overloaded." in text
    kept = dataclasses.replace(diagnoses["nothing"], design_before=before, design_after=before)
    assert "stays as it is: grade, 5 mm" in diagnosis_page(report_of(kept)).design[0]


@pytest.mark.parametrize(
    ("n_cables", "start"),
    [
        (2, "The robot has fewer cables than degrees of freedom:"),
        (4, "The study has no workspace or no selection"),
    ],
)
def test_a_robot_with_too_few_cables_is_told(
    n_cables: int, start: str, diagnoses: dict[str, Diagnosis]
) -> None:
    study = diagnoses["nothing"].study
    exits = frozen_array(np.arange(3.0 * n_cables).reshape(n_cables, 3))
    robot = dataclasses.replace(study.robot, exit_points_m=exits)
    other = dataclasses.replace(diagnoses["nothing"], study=dataclasses.replace(study, robot=robot))
    assert diagnosis_page(report_of(other)).design[0].startswith(start)


def test_moved_exit_points_are_summed_up(diagnoses: dict[str, Diagnosis]) -> None:
    found = diagnoses["pulley"]
    points = [e for e in SHIPPED.of(found.machine) if e.id == "anchor_offset"]
    findings = tuple(
        Finding(
            e, {name: Estimate(size, 1e-3) for name in ("x_m", "y_m", "z_m")}, (), gain, 0.01, ()
        )
        for e, size, gain in zip(points[::-1], (0.03, 0.02), (0.5, 0.2), strict=False)
    )
    page = diagnosis_page(report_of(dataclasses.replace(found, findings=findings)))
    (statement,) = page.findings
    assert statement.title.replace("\xa0", " ") == (
        "The exit points of cables 2 and 3 are not where the drawing has them, by 34.6 to 52 mm"
    )
    assert statement.text.replace("\xa0", " ").startswith("cable 2: 34.6")
    significance = next(one for one in page.sureness if one.title.startswith("Significance"))
    assert significance.title == "Significance of anchor_offset of cables 2 and 3"
    assert "they take, each by itself, 20" in significance.text.replace("\xa0", " ")


def test_the_chance_in_the_text_is_the_one_in_the_search(
    pages: Callable[[str], str], diagnoses: dict[str, Diagnosis]
) -> None:
    text = visible(pages("pulley"))
    assert f"with a chance below {100.0 * SIGNIFICANCE:.2f} %" in text
    assert diagnoses["pulley"].measured.sha256 in text


def test_where_structure_is_left_is_told(diagnoses: dict[str, Diagnosis]) -> None:
    place = diagnoses["drift"].left_in
    assert place is not None
    assert place.reading.startswith("tension")
    text = diagnosis_page(report_of(diagnoses["drift"])).verdict.text
    assert f"({place.reading}, rows " in text
    assert diagnoses["pulley"].left_in is None


def test_what_was_added_and_is_not_found_is_told(diagnoses: dict[str, Diagnosis]) -> None:
    found = diagnoses["pulley"]
    pruned = dataclasses.replace(found, findings=())
    gone = dataclasses.replace(pruned, withdrawn=(RejectedEffect("pulley_radius", "time_s", 0.4),))
    for diagnosis, remark in (
        (found, "added pulley_radius"),
        (pruned, "added pulley_radius, which others made superfluous later"),
        (gone, "added pulley_radius, withdrawn later"),
    ):
        rounds = table(
            tree(report_of(diagnosis).section("search"), "diagnosis"), "Each round"
        ).groups
        assert rounds[0].remark.endswith(f"; {remark}")


@pytest.mark.parametrize("kind", ["pulley", "nothing", "drift"])
def test_everything_is_shown_and_every_table_rectangular(
    kind: str, diagnoses: dict[str, Diagnosis]
) -> None:
    report = report_of(diagnoses[kind])
    shown = unescape(render_html(report))
    assert [text for text in texts(report) if text not in shown] == []
    found = tables(report)
    assert len(found) >= 6
    for one in found:
        for row in (row for group in one.groups for row in group.rows):
            assert len(row.cells) == len(one.columns)


def test_both_files_are_written_whole(diagnoses: dict[str, Diagnosis], tmp_path: Path) -> None:
    from pypdf import PdfReader

    write_diagnosis(diagnoses["pulley"], tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["diagnosis.html", "diagnosis.pdf"]
    pdf = PdfReader(tmp_path / "diagnosis.pdf")
    assert "What was wrong" in pdf.pages[0].extract_text()
    assert len(pdf.outline) >= 8


def test_the_lengths_alone_lead_to_the_platform(pages: Callable[[str], str]) -> None:
    text = visible(pages("pulley"))
    first, last = re.search(
        r"By the lengths alone the platform would be (\S+) mm off; now it is (\S+) mm", text
    ).groups()
    assert float(last) < 0.1 * float(first)
    assert "Position of the platform [mm]" in text
    assert "would be" not in visible(pages("nothing"))


@pytest.mark.parametrize(
    ("n_cables", "expected"),
    [
        (2, "fewer cables than degrees of freedom"),
        (3, ""),
        (4, "1 cable to spare. The internal forces of each row are taken from its own"),
        (5, "2 cables to spare"),
    ],
)
def test_where_internal_forces_come_from(
    diagnoses: dict[str, Diagnosis], n_cables: int, expected: str
) -> None:
    diagnosis = diagnoses["nothing"]
    exits = np.resize(diagnosis.machine.robot.exit_points_m, (n_cables, 3))
    robot = dataclasses.replace(diagnosis.machine.robot, exit_points_m=frozen_array(exits))
    machine = dataclasses.replace(diagnosis.machine, robot=robot)
    report = report_of(dataclasses.replace(diagnosis, machine=machine))
    text = said(tree(report.section("assumptions"), "diagnosis"))
    assert expected in text
    told = "cables than degrees of freedom" in text or "to spare" in text
    assert told == bool(expected)
