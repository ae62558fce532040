"""Small models of our own in the formats of CASPR and WireX."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

EXITS = [(x, y, 4.0) for x in (-3.0, 3.0) for y in (-2.0, 2.0)] + [
    (x, y, 0.25) for x in (-3.0, 3.0) for y in (-2.0, 2.0)
]
HELD = [(x, y, 0.2) for x in (-0.2, 0.2) for y in (-0.1, 0.1)] + [
    (x, y, -0.2) for x in (-0.2, 0.2) for y in (-0.1, 0.1)
]
FREE = 'type="SPATIAL_EULER_XYZ" q_initial="0.5 0 2 0 0 0"'
LIMITS = 'q_min="-1 -1 1 -3 -3 -3" q_max="1 1 3 3 3 3"'


def text_of(point: Sequence[float]) -> str:
    return " ".join(f"{one:g}" for one in point)


def link(number: int = 1, joint: str = FREE, mass: str = "20", centre: str = "0 0 0.05") -> str:
    return (
        f'<link_rigid num="{number}" name="Test rig">\n<joint {joint}/>\n'
        f"<physical><mass>{mass}</mass><com_location>{centre}</com_location></physical>\n"
        "<parent><num>0</num><location>0 0 0</location></parent>\n</link_rigid>\n"
    )


def bodies(links: str = "", root: bool = True) -> str:
    inner = f"<links>\n{links or link()}</links>\n"
    head = '<?xml version="1.0"?>\n'
    doctype = '<!DOCTYPE bodies_system SYSTEM "../missing/bodies.dtd">\n'
    return f"{head}{doctype}<bodies_system>\n{inner}</bodies_system>\n" if root else head + inner


def attachment(link_number: int, place: Sequence[float]) -> str:
    return (
        f"<attachment><link>{link_number}</link><location>{text_of(place)}</location></attachment>"
    )


def cable(ends: str, force_min: float = 5.0, reference: str = "joint") -> str:
    return (
        f'<cable_ideal name="c" attachment_reference="{reference}">\n'
        f"<properties><force_min>{force_min}</force_min><force_max>900</force_max></properties>\n"
        f"<attachments>{ends}</attachments>\n</cable_ideal>\n"
    )


def cables(
    exits: Sequence[Sequence[float]] = EXITS,
    held: Sequence[Sequence[float]] = HELD,
    default: str = "first",
    **named: object,
) -> str:
    both = zip(exits, held, strict=True)
    inner = "".join(cable(attachment(0, a) + attachment(1, b), **named) for a, b in both)  # type: ignore[arg-type]
    return cable_file(f'<cable_set id="first">\n{inner}</cable_set>\n', default)


def cable_file(sets: str, default: str = "first") -> str:
    return f'<?xml version="1.0"?>\n<cables default_cable_set="{default}">\n{sets}</cables>\n'


def write_caspr(folder: Path, bodies_text: str, cables_text: str) -> Path:
    (folder / "rig_cables.xml").write_text(cables_text, encoding="utf-8")
    path = folder / "rig_bodies.xml"
    path.write_text(bodies_text, encoding="utf-8")
    return path


def chain(base: Sequence[float], held: Sequence[float], more: str = 'a33="1" radius="0.03"') -> str:
    def point(one: Sequence[float]) -> str:
        return " ".join(f'{name}="{value}"' for name, value in zip("xyz", one, strict=True))

    return f"<chain><base {point(base)} {more}/><platform {point(held)}/></chain>\n"


ROPE = '<cable name="r" elasticity="6e10" radius="0.002" breaking_load="9000" weight="0.06"/>\n'
ENTERED = '<platform mass="40"><centerofgravity x="0" y="0" z="0.1"/></platform>'
NOBODY = '<platform mass="25"><centerofgravity x="0" y="1" z="0.2"/></platform>'
NOBODYS_ROPE = (
    '<cable name="r" elasticity="1.1e11" radius="0.006" breaking_load="40000" weight="0.023"/>\n'
)


def wirex(
    platform: str = ENTERED,
    rope: str = ROPE,
    more: str = 'a33="1" radius="0.03"',
    pattern: str = "3R3T",
    held: Sequence[Sequence[float]] = HELD,
) -> str:
    chains = "".join(chain(a, b, more) for a, b in zip(EXITS, held, strict=True))
    return (
        f'<models version="0.32">\n<robot name="Test rig" motionpattern="{pattern}">\n'
        f"<geometry>\n{chains}</geometry>\n{platform}\n</robot>\n{rope}</models>\n"
    )
