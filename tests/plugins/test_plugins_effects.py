"""Effects that plugins bring in: found, declared, read back, and left out where they are faulty."""

from __future__ import annotations

import dataclasses
import sys
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from plugin_samples import hook, install_plugin
from twins.dataset import make
from twins.robots import YARD3

from designer import effects
from designer.cli.commands import main, schema
from designer.diagnosis.check import check
from designer.diagnosis.diagnose import diagnose_study
from designer.diagnosis.study import diagnosed_config
from designer.effects.effect import Effect, Readings
from designer.effects.load import find_flaw, load_effects
from designer.effects.registry import EFFECTS, SHIPPED, KnownEffects
from designer.errors import EffectError, InputError
from designer.io.config import read_study
from designer.measured.read import read_measured
from designer.plugins import find_plugins
from designer.study import Study, as_built_by, declared_settings

DRIFT = """
from dataclasses import replace
from designer.effects.effect import Effect, Parameter, Size
from designer.units import Dimension

PER_KELVIN = Dimension("a force per temperature", "N/K", "3 N/K")
SIZE = Size(0.1, (-1e3, 1e3), (-5.0, 5.0))
PARAMETER = Parameter("drift_N_per_K", PER_KELVIN, SIZE)
EFFECT = Effect(
    id="load_cell_drift", summary="the load cells drift with temperature",
    law="tension plus drift times (T - 20 °C)", source="definition", parameters=(PARAMETER,),
    on_readings=lambda readings, values, measured: replace(
        readings,
        tension_N=readings.tension_N
        + values["drift_N_per_K"] * (measured.temperature_C[:, None] - 20.0),
    ),
    needs=frozenset({"tension", "temperature"}),
)

def drift(**changes):
    return replace(EFFECT, parameters=(replace(PARAMETER, **changes),))
"""
LIGHTER = """
from dataclasses import replace
from designer.effects.effect import Effect, Parameter, Size
from designer.units import MASS

def lighter(machine, values):
    platform = machine.robot.platform
    platform = replace(platform, mass_kg=platform.mass_kg - values["ballast_kg"])
    return replace(machine, robot=replace(machine.robot, platform=platform))

EFFECT = Effect(
    id="lost_ballast", summary="ballast was lost", law="mass minus ballast", source="definition",
    parameters=(Parameter("ballast_kg", MASS, Size(1.0, (-50.0, 50.0), (0.0, 20.0))),),
    on_machine=lighter, reaches_design=True,
)
"""


def plugin(setup: str, item: str = "EFFECT") -> str:
    return setup + hook(f"return [{item}]", "register_effects")


def known() -> KnownEffects:
    return load_effects(find_plugins())


def twin(folder: Path, drift_N_per_K: float) -> Path:
    """Write measured data whose tensions drift with temperature; return the config's path."""
    dataset = make(YARD3)
    shift = drift_N_per_K * (dataset.scene.temperature_C[:, None] - 20.0)
    return dataclasses.replace(dataset, tension_N=dataset.tension_N + shift).write(folder)


def test_ours_come_in_by_the_door_in_their_order() -> None:
    assert find_plugins(with_plugins=False).problems == ()
    assert load_effects(find_plugins(with_plugins=False)) == SHIPPED
    assert SHIPPED.effects == EFFECTS


def test_ours_which_are_not_examined_at_each_start_have_no_flaw() -> None:
    assert [find_flaw(effect) for effect in EFFECTS] == [""] * len(EFFECTS)


def test_every_effect_of_a_file_is_registered() -> None:
    files = Path(effects.__file__).parent.glob("*.py")
    modules = [import_module(f"designer.effects.{path.stem}") for path in files]
    written = [e for module in modules for e in vars(module).values() if isinstance(e, Effect)]
    assert {effect.id for effect in written} == SHIPPED.by_id.keys()


@pytest.mark.slow
def test_those_of_a_plugin_act_after_ours(site) -> None:
    install_plugin(site, "acme-drift", plugin(DRIFT))
    brought = known()
    assert brought.problems == ()
    assert [*brought.by_id] == [*SHIPPED.by_id, "load_cell_drift"]
    assert [*load_effects(find_plugins(with_plugins=False)).by_id] == [*SHIPPED.by_id]


@pytest.mark.slow
def test_a_plugin_may_bring_grades_and_effects(site) -> None:
    install_plugin(site, "acme-both", plugin(DRIFT) + hook("return []"))
    (both,) = (p for p in find_plugins().loaded if p.name == "acme-both")
    assert {*both.hooks} == {"register_grades", "register_effects"}
    assert "load_cell_drift" in known().by_id


@pytest.mark.slow
def test_the_diagnosis_finds_it_and_the_config_keeps_it(site, tmp_path) -> None:
    install_plugin(site, "acme-drift", plugin(DRIFT))
    rivals = ("pulley_radius", "thermal_expansion", "tension_bias", "load_cell_drift")
    few = KnownEffects(tuple(one for one in known().effects if one.id in rivals))
    study = read_study(twin(tmp_path, 2.0), few)
    assert study.measurements is not None
    found = diagnose_study(study, read_measured(study))
    (finding,) = found.findings
    assert finding.effect.id == "load_cell_drift"
    estimate = finding.parameters["drift_N_per_K"]
    assert estimate.value == pytest.approx(2.0, abs=4.0 * estimate.std)
    assert not found.is_unexplained
    assert found.to_dict()["left_out"] == []

    better = tmp_path / "config.diagnosed.yaml"
    better.write_text(diagnosed_config(found, tmp_path), encoding="utf-8")
    (declared,) = read_study(better, known()).effects
    assert declared.id == "load_cell_drift"
    assert declared.parameters == {"drift_N_per_K": pytest.approx(estimate.value)}


STUDY = """\
robot:
  anchors: [[0, 0, 12], [30, 0, 12], [15, 26, 12]]
  platform: {mass: 180 kg}
cable: {density: 5290 kg/m^3, youngs_modulus: 62.7 GPa, allowable_stress: 198 MPa}
pose: [15, 9, 4]
effects:
"""


def study_of(folder: Path, effects: str) -> Study:
    path = folder / "study.yaml"
    path.write_text(STUDY + f"  {effects}\n", encoding="utf-8")
    return read_study(path, known())


@pytest.mark.slow
def test_a_config_declares_it_with_its_units(site, tmp_path) -> None:
    install_plugin(site, "acme-ballast", plugin(LIGHTER))
    study = study_of(tmp_path, "lost_ballast: {ballast_kg: 2000 g}")
    assert as_built_by(study).robot.platform.mass_kg == pytest.approx(178.0)
    assert study.source.entries[-1].field == "effects.lost_ballast.ballast_kg"
    assert study.source.entries[-1].value_SI == "2 kg"


@pytest.mark.cases_by_default(1)
@pytest.mark.parametrize(
    ("effects", "words"),
    [
        ("lost_balast: {ballast_kg: 2}", r"study.yaml:7: .*did you mean 'lost_ballast'\?"),
        ("lost_ballast: {ballast_kg: 2 m}", "study.yaml:7: .*unit meter"),
        ("lost_ballast: {balast_kg: 2}", "unknown parameter 'balast_kg'"),
        ("lost_ballast: {}", "a mapping with ballast_kg"),
    ],
)
def test_mistakes_in_a_config_are_told_as_for_ours(site, tmp_path, effects, words) -> None:
    install_plugin(site, "acme-ballast", plugin(LIGHTER))
    with pytest.raises(InputError, match=words):
        study_of(tmp_path, effects)


@pytest.mark.slow
def test_it_may_be_unknown_from_the_start(site, tmp_path) -> None:
    install_plugin(site, "acme-drift", plugin(DRIFT))
    path = twin(tmp_path, 2.0)
    text = path.read_text(encoding="utf-8")
    path.write_text(text.replace("measured.csv", "measured.csv\n  unknown: [load_cell_drift]"))
    study = read_study(path, known())
    assert study.measurements is not None
    assert study.measurements.unknown == ("load_cell_drift",)
    with pytest.raises(InputError, match=r"unknown\[0\]: 'load_cell_drift' is not known"):
        read_study(path)


@pytest.mark.slow
def test_its_unknown_is_fitted_where_nothing_is_declared(site, tmp_path) -> None:
    install_plugin(site, "acme-drift", plugin(DRIFT))
    path = twin(tmp_path, 2.0)
    text = path.read_text(encoding="utf-8")
    path.write_text(text.replace("measured.csv", "measured.csv\n  unknown: [load_cell_drift]"))
    study = read_study(path, known())
    assert study.measurements is not None
    told = check(study, read_measured(study))
    assert told.fitted is not None
    assert told.fitted.tension_N is not None and told.without.tension_N is not None
    assert told.fitted.tension_N.rms.value < 0.5 * told.without.tension_N.rms.value


# what the hook gives, beside DRIFT, and what is said of it
FAULTS = [
    ("7", "register_effects() gave int, not an Effect"),
    ("PARAMETER", "register_effects() gave Parameter, not an Effect"),
    (
        "drift(size=None)",
        "effect 'load_cell_drift': the size of drift_N_per_K is NoneType, not a Size or a",
    ),
    (
        "drift(size=lambda m: 3)",
        "cannot be built: TypeError: the size of drift_N_per_K is int",
    ),
    (
        "drift(size=lambda m: 1 / 0)",
        "cannot be built: ZeroDivisionError",
    ),
    (
        "drift(size=lambda m: exit(3))",
        "cannot be built: SystemExit: 3",
    ),
    ("replace(EFFECT, can_have=lambda m: 1 / 0)", "cannot be built: ZeroDivisionError"),
    ("replace(EFFECT, can_have=None)", "cannot be built: TypeError"),
    ("replace(EFFECT, id='creep')", "effect 'creep' is in 'builtin-effects' already"),
    ("replace(EFFECT, id='Drift!')", "'Drift!' is no effect id"),
    ("replace(EFFECT, id='anchors')", "'anchors' is no effect id"),
    ("replace(EFFECT, id=7)", "7 is no effect id"),
    ("replace(EFFECT, parameters=())", "it has no parameter"),
    ("replace(EFFECT, parameters=(1,))", "a parameter is int, not"),
    ("replace(EFFECT, parameters=2 * EFFECT.parameters)", "two of its parameters have one name"),
    (
        "drift(name='cable')",
        "'cable' is no parameter name",
    ),
    (
        "drift(dimension=replace(PER_KELVIN, unit='N'))",
        "the dimension of 'drift_N_per_K': its example '3 N/K' has the unit",
    ),
    (
        "drift(dimension='N/K')",
        "the dimension of 'drift_N_per_K' is no Dimension",
    ),
    (
        "drift(size=replace(SIZE, bounds=(1.0, 2.0)))",
        "drift_N_per_K has no bounds around its neutral value 0",
    ),
    (
        "drift(size=lambda m: replace(SIZE, bounds=(1.0, 2.0)))",
        "drift_N_per_K has no bounds around its neutral value 0",
    ),
    (
        "drift(is_optional=True, size=lambda m: replace(SIZE, neutral=0.5))",
        "drift_N_per_K is neutral at 0.5 (expected 0, as it may be left out)",
    ),
    (
        "drift(size=replace(SIZE, typical=float('nan')))",
        "drift_N_per_K has a number that is not finite",
    ),
    (
        "drift(size=replace(SIZE, typical=0.0))",
        "drift_N_per_K has no typical size above 0",
    ),
    (
        "replace(EFFECT, on_readings=None)",
        "acts on several of machine, readings and poses or on none",
    ),
    ("replace(EFFECT, needs={'sun'})", "it needs 'sun' (expected"),
    ("replace(EFFECT, law='')", "its law is no text"),
    ("replace(EFFECT, starts=({'x': 1.0},))", "starts from {'x': 1"),
    ("replace(EFFECT, starts=(1.0,))", "be built: AttributeError"),
    ("replace(EFFECT, cable=1)", "expected takes_cable"),
]


@pytest.mark.slow  # each starts a process for the plugin
@pytest.mark.parametrize(("item", "words"), FAULTS)
def test_a_faulty_effect_is_one_line_and_the_rest_works(site, item, words) -> None:
    install_plugin(site, "acme-faulty", plugin(DRIFT, item))
    install_plugin(site, "acme-ballast", plugin(LIGHTER))
    brought = known()
    (problem,) = brought.problems
    assert problem.startswith("plugin acme-faulty (acme-faulty 1.2): ")
    assert words in problem
    assert problem.endswith(": left out")
    assert "\n" not in problem
    assert [*brought.by_id] == [*SHIPPED.by_id, "lost_ballast"]


@pytest.mark.cases_by_default(1)
@pytest.mark.parametrize(
    ("code", "words"),
    [
        (hook("import sys; sys.exit(2)", "register_effects"), "register_effects(): SystemExit: 2"),
        ("import sys; sys.exit(1)", "cannot be loaded: SystemExit: 1"),
        ("import nothing_of_the_kind", "cannot be loaded: ModuleNotFoundError"),
        (hook("raise KeyError('x')", "register_effects"), "fails in register_effects(): KeyError"),
        (hook("return 5", "register_effects"), "it returned int, not a list"),
        (hook("return []", "register_effect"), "unknown hook 'register_effect'"),
    ],
)
def test_a_plugin_that_fails_is_one_line(site, code, words) -> None:
    install_plugin(site, "acme-fails", code)
    (problem,) = known().problems
    assert problem.startswith("plugin acme-fails (acme-fails 1.2)")
    assert words in problem
    assert known().by_id == SHIPPED.by_id


def test_the_schema_says_which_plugin_it_leaves_out(site, capsys) -> None:
    install_plugin(site, "acme-fails", hook("raise KeyError('x')", "register_effects"))
    schema()
    printed = capsys.readouterr()
    assert printed.err.startswith("plugin acme-fails (acme-fails 1.2) fails in register_effects()")
    assert '"drum_layering"' in printed.out


@pytest.mark.slow
def test_one_id_of_two_plugins_keeps_the_first(site) -> None:
    install_plugin(site, "acme-one", plugin(DRIFT))
    install_plugin(site, "acme-two", plugin(DRIFT))
    assert known().problems == (
        "plugin acme-two (acme-two 1.2): effect 'load_cell_drift' is in 'acme-one' already: "
        "left out",
    )


BROKEN_LAWS = [
    ("lambda *_: 1 / 0", "ZeroDivisionError"),
    ("lambda readings, values, measured: None", "it returned NoneType, not Readings"),
    (
        "lambda r, v, m: replace(r, tension_N=r.tension_N[:5])",
        "its tension_N is no array (120, 3) of numbers",
    ),
    ("lambda r, v, m: replace(r, tension_N=r.tension_N / 0)", "divide by zero"),
    ("lambda r, v, m: replace(r, tension_N=r.tension_N * float('inf'))", "tension_N is infinite"),
    ("lambda r, v, m: values['drift']", "NameError"),
]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("law", "words"),
    [BROKEN_LAWS[0], *(pytest.param(*one, marks=pytest.mark.slow) for one in BROKEN_LAWS[1:])],
)
def test_a_law_that_fails_at_work_is_left_out_of_the_diagnosis(site, tmp_path, law, words) -> None:
    item = f"replace(EFFECT, on_readings={law})"
    install_plugin(site, "acme-broken", plugin(DRIFT, item))
    study = read_study(twin(tmp_path, 0.0), known())
    assert study.known_effects.problems == ()
    assert study.measurements is not None
    found = diagnose_study(study, read_measured(study))
    assert found.findings == ()
    (problem,) = found.to_dict()["left_out"]
    start = "plugin acme-broken (acme-broken 1.2): effect 'load_cell_drift' fails at work: "
    assert problem.startswith(start)
    assert words in problem
    assert problem.endswith(": left out")


@pytest.mark.cases_by_default(1)
@pytest.mark.parametrize(
    ("law", "words"),
    [
        ("lambda m, v: exit(3)", "acme-broken 1.2.: effect 'lost_ballast' .* SystemExit: 3"),
        ("lambda m, v: v['mass']", "KeyError: 'mass'"),
        ("lambda m, v: m.robot", "returned Robot"),
    ],
)
def test_a_declared_effect_that_fails_at_work_stops_with_one_line(
    site, tmp_path, law, words
) -> None:
    item = f"replace(EFFECT, on_machine={law})"
    install_plugin(site, "acme-broken", plugin(LIGHTER, item))
    study = study_of(tmp_path, "lost_ballast: {ballast_kg: 2}")
    with pytest.raises(EffectError, match=words) as caught:
        as_built_by(study)
    assert "\n" not in str(caught.value)


@pytest.mark.slow
def test_an_effect_that_this_robot_cannot_have_is_not_passed_over(site, tmp_path) -> None:
    item = "replace(EFFECT, can_have=lambda m: not m.robot.is_point_mass)"
    install_plugin(site, "acme-ballast", plugin(LIGHTER, item))
    study = study_of(tmp_path, "lost_ballast: {ballast_kg: 2}")
    with pytest.raises(InputError, match=r"study.yaml:7: effects.lost_ballast: this robot cannot"):
        declared_settings(study)


@pytest.mark.slow
def test_the_commands_take_it_and_leave_it(site, tmp_path, capsys, monkeypatch) -> None:
    install_plugin(site, "acme-ballast", plugin(LIGHTER))
    install_plugin(site, "acme-fails", "raise RuntimeError('no licence')")
    study_of(tmp_path, "lost_ballast: {ballast_kg: 80}")
    monkeypatch.chdir(tmp_path)

    def run(*arguments: str) -> tuple[int, str, list[str]]:
        monkeypatch.setattr(sys, "argv", ["designer", *arguments])
        with pytest.raises(SystemExit) as stop:
            main()
        told = capsys.readouterr()
        return int(stop.value.code or 0), told.out, told.err.splitlines()

    status, out, err = run("size", "study.yaml")
    assert status == 0
    assert "residuals: closure" in out
    problem = "plugin acme-fails (acme-fails 1.2) cannot be loaded: RuntimeError: no licence"
    assert f"{problem}: left out" in err

    status, out, err = run("size", "--no-plugins", "study.yaml")
    assert status == 2
    (line,) = err
    assert line.startswith("study.yaml:7: effects.lost_ballast: unknown effect 'lost_ballast'")


@pytest.mark.slow
def test_readings_reach_a_plugin_as_arrays_that_it_cannot_spoil(site, tmp_path) -> None:
    law = "lambda r, v, m: (m.temperature_C.__setitem__(0, 1e9), r)[1]"
    item = f"replace(EFFECT, on_readings={law})"
    install_plugin(site, "acme-vandal", plugin(DRIFT, item))
    study = read_study(twin(tmp_path, 0.0), known())
    measured = read_measured(study)
    before = np.array(measured.temperature_C)
    assert study.measurements is not None
    found = diagnose_study(study, measured)
    assert np.array_equal(measured.temperature_C, before)
    assert "read-only" in found.study.known_effects.problems[0]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ("readings.length_m.tolist()", "its length_m is no array"),
        ("readings.length_m[:, :1]", "its length_m is no array"),
        ("readings.length_m.astype(int)", "its length_m is no array"),
        ("readings.length_m / 0.0", "its length_m is infinite"),
    ],
)
def test_readings_of_another_kind_are_refused(site, changed: str, said: str) -> None:
    law = f"on_readings=lambda readings, *_: replace(readings, length_m={changed}))"
    install_plugin(site, "acme-drift", plugin(DRIFT, f"replace(EFFECT, {law}"))
    effect = known().by_id["load_cell_drift"]
    with np.errstate(divide="ignore"), pytest.raises(EffectError, match=said):
        effect.on_readings(Readings(np.ones((2, 3)), np.ones((2, 3))), effect.neutral, None)
