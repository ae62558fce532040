"""Numbers as text."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from designer.report import format as fmt


def plain(text: str) -> str:
    """Undo the special spaces and the minus sign."""
    return text.replace("\u202f", " ").replace("\u00a0", " ").replace("−", "-")


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (fmt.millimetres(0.0512303), "51.2 mm"),
        (fmt.millimetres(0.00318), "3.18 mm"),
        (fmt.newtons(371035.75), "371.0 kN"),
        (fmt.newtons(950.0), "950.0 N"),
        (fmt.newtons(13.5e6), "13.50 MN"),
        (fmt.pascals(180e6), "180 MPa"),
        (fmt.pascals(200e9), "200 GPa"),
        (fmt.pascals(451.62e6), "451.6 MPa"),
        (fmt.kilograms(3217.4), "3 217 kg"),
        (fmt.kilograms_per_metre(0.042), "0.042 kg/m"),
        (fmt.cubic_metres(14_925_468.0), "14 930 000 m³"),
        (fmt.metres(-0.001), "-0.001 m"),
        (fmt.metres(8.9e-7), "8.9 × 10⁻⁷ m"),
        (fmt.metres(-1e-12), "0.00 m"),
        (fmt.position([256.5154, 10.35, -40.0]), "(256.52, 10.35, -40.00) m"),
        (fmt.count(20_000), "20 000"),
        (fmt.percent(0.0405), "4.05 %"),
        (fmt.signed_percent(0.0203), "+2.0 %"),
        (fmt.signed_percent(-0.0203), "-2.0 %"),
        (fmt.power_of_ten(3.14e-12, "m"), "3.1 × 10⁻¹² m"),
        (fmt.power_of_ten(0.0, "m"), "0 m"),
        (fmt.factor(3.0564), "3.06"),
        (fmt.number(9999.96), "10 000"),
        (fmt.number(-0.0), "0"),
        (fmt.trimmed(2.0), "2"),
        (fmt.trimmed(2.5), "2.5"),
        (fmt.trimmed(200.0), "200"),
        (fmt.plural(1, "grade"), "1 grade"),
        (fmt.plural(19, "grade"), "19 grades"),
        (fmt.listing(["a"]), "a"),
        (fmt.listing(["a", "b", "c"]), "a, b and c"),
    ],
)
def test_text_of_a_value(text: str, expected: str) -> None:
    assert plain(text) == expected


@pytest.mark.parametrize(
    "show", [fmt.newtons, fmt.metres, fmt.millimetres, fmt.percent, fmt.number]
)
def test_a_missing_number_has_no_unit(show: object) -> None:
    assert callable(show)
    assert show(math.nan) == fmt.MISSING


@given(st.floats())
def test_no_number_is_wider_than_a_column(value: float) -> None:
    shows = (fmt.number, fmt.newtons, fmt.metres, fmt.millimetres, fmt.percent, fmt.kilograms)
    texts = [show(value) for show in (*shows, fmt.utilisation, fmt.signed_percent)]
    texts += [fmt.fixed(value, 3), fmt.trimmed(value), fmt.position([value])]
    assert max(map(len, texts)) <= 24
    assert not any(word in text for word in ("nan", "inf") for text in texts)


def test_no_figure_can_be_broken_over_lines() -> None:
    texts = [fmt.newtons(371e3), fmt.position([1e3, 2.0, 3.0]), fmt.count(10**6)]
    assert all(" " not in text for text in texts)


@pytest.mark.parametrize(
    ("fraction", "expected"),
    [(0.998, "99.8 %"), (1.0, "100.0 %"), (1.00004, "over 100 %"), (1.04, "104.0 %")],
)
def test_utilisation_never_hides_an_excess(fraction: float, expected: str) -> None:
    assert plain(fmt.utilisation(fraction)) == expected


def test_utilisation_of_a_cable_that_cannot_hold() -> None:
    assert fmt.utilisation(math.inf) == "not held"


@pytest.mark.parametrize(
    ("part", "expected"), [(0, "0 %"), (810, "4.05 %"), (19_999, "over 99.9 %"), (20_000, "100 %")]
)
def test_share_is_full_only_for_all(part: int, expected: str) -> None:
    assert plain(fmt.share(part, 20_000)) == expected


def test_column_keeps_the_digits_of_its_smallest_number() -> None:
    assert fmt.decimals([1130.0, 64.05]) == 1
    assert fmt.decimals([1130.0, 640.5]) == 0
    assert fmt.decimals([0.0, math.inf, math.nan]) == 0
    assert fmt.decimals([1e-9]) == 3


@given(st.floats(1e-6, 1e9), st.integers(1, 6))
def test_number_is_close_to_the_value(value: float, digits: int) -> None:
    shown = float(plain(fmt.number(value, digits)).replace(" ", ""))
    assert shown == pytest.approx(value, rel=0.51 * 10.0 ** (1 - digits))


def test_notes_of_tables_are_set_as_print() -> None:
    assert fmt.sentence("mass over d^2 is 9 % above") == "Mass over d² is 9 % above"
    place = fmt.printed("unirope-7x19 fails at (243.5, -0.3, -40) m")
    assert place == "unirope-7x19 fails at (243.5, −0.3, −40) m"


@pytest.mark.parametrize(
    ("text", "short"),
    [
        ("[0, 0, 0.0872664626] rad", "[0, 0, 0.0872665] rad"),
        ("[-7.11966, 5.47261, 5.41063] m", "[-7.11966, 5.47261, 5.41063] m"),
        ("1.23456789e10 Pa", "1.23456789e10 Pa"),
        ("anchors", "anchors"),
    ],
)
def test_shorter_cuts_what_a_change_of_units_brought(text: str, short: str) -> None:
    assert fmt.shorter(text) == short


def test_forces_to_be_compared_have_one_unit() -> None:
    assert [plain(text) for text in fmt.newtons_alike(185.4, 1200.0)] == ["185.4 N", "1 200 N"]
    assert [plain(text) for text in fmt.newtons_alike(1850.0, 12e6)] == ["1.850 kN", "12 000 kN"]
    assert fmt.newtons_alike(math.nan, 5.0)[0] == fmt.MISSING
