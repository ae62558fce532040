"""Pages that the code writes: a line `<!-- generated: NAME -->` is replaced by its text."""

import csv
import re
from collections import Counter
from pathlib import Path

import gallery
from sphinx.util.logging import getLogger
from typer.main import get_command

from designer.cli.commands import app as commands
from designer.effects.effect import NEEDS
from designer.effects.registry import SHIPPED
from designer.io.config.json_schema import study_schema
from designer.model.verdict import Verdict
from designer.reference.page import compute, markdown
from designer.resources import data_folder

_MARK = re.compile(r"^<!-- generated: (\w+) -->$", re.MULTILINE)
_LOGGER = getLogger(__name__)
_NOWHERE = {"type": "null"}
GALLERY = Path(__file__).parents[1] / "_gallery" / "reports"
PAIRS = Path(__file__).parents[2] / "tests" / "pairs" / "outcomes.csv"
PAIRS_HEAD = ("option", "computed with", "refused with", "reported as not covered with")


def fill(app, page, source):
    """Sphinx calls it for each page that it reads."""
    source[0] = _MARK.sub(lambda found: WRITERS[found[1]](), source[0])


def config():
    """Every field of the study: one table for each section."""
    properties = study_schema(SHIPPED.by_id)["properties"]
    single = {name: one for name, one in properties.items() if not _sections(one)}
    text = f"## On the first level\n\n{_table(_rows({'properties': single}, ''))}\n"
    for name, schema in properties.items():
        if name not in single and name != "effects":
            about = schema.get("description", "")
            rows = dict.fromkeys(_rows_in(schema, ""))
            text += f"\n## `{name}`\n\n{about}\n\n{_table(rows)}\n"
    return text


def _rows_in(schema, path):
    for section in _sections(schema):
        yield from _rows(section, path)


def _rows(section, path):
    for name, one in section["properties"].items():
        place = f"{path}.{name}".lstrip(".")
        default = f"`{_plain(one['default'])}`" if "default" in one else ""
        if name in section.get("required", ()):
            default = "required"
        yield f"`{place}`", _kind(one), default, _meaning(one)
        yield from _rows_in(one, place)


def _meaning(one):
    return one.get("description", "").replace("|", "\\|")


def _plain(value):
    if isinstance(value, list):
        return f"[{', '.join(map(_plain, value))}]"
    return f"{value:g}" if isinstance(value, float) else str(value).lower()


def _sections(schema):
    """Mappings with fields that a schema allows, wherever in lists and alternatives."""
    if "properties" in schema:
        return [schema]
    parts = [*schema.get("anyOf", ()), *schema.get("oneOf", ())]
    below = (schema.get("items"), schema.get("additionalProperties"))
    parts += [one for one in below if isinstance(one, dict)]
    return [section for part in parts for section in _sections(part)]


def _kind(schema):
    """What may stand there, in words."""
    if "x-unit" in schema:
        words = [f"`{one['const']}`" for one in schema["anyOf"] if "const" in one]
        number = next(one for one in schema["anyOf"] if "minimum" in one)
        bounds = f"{number['minimum']:g} to {number['maximum']:g}"
        return " or ".join([f"{schema['x-unit'] or 'number'}, {bounds}", *words])
    kinds = [one for one in (*schema.get("anyOf", ()), *schema.get("oneOf", ())) if one != _NOWHERE]
    if kinds:
        return " or ".join(dict.fromkeys(map(_kind, kinds)))
    if "enum" in schema or "const" in schema:
        return ", ".join(f"`{one}`" for one in schema.get("enum", [schema.get("const")]))
    return _KINDS.get(schema.get("type"), lambda _: "quantity")(schema)


def _list(schema):
    least, most = schema.get("minItems"), schema.get("maxItems")
    return f"list{f' of {least}' if least == most else ''}: {_kind(schema['items'])}"


_KINDS = {
    "array": _list,
    "integer": lambda schema: f"whole number, {schema['minimum']} to {schema['maximum']}",
    "object": lambda _: "mapping",
    "string": lambda _: "text",
    "boolean": lambda _: "`true`, `false`",
}


def _table(rows, head=("field", "value", "default", "meaning")):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join([*lines, *("| " + " | ".join(row) + " |" for row in rows)]) + "\n"


def effects():
    """All effects: what they change, their parameters, what the data must have."""
    return _table(
        (
            (
                f"`{one.id}`",
                ", ".join(f"`{p.name.format(cable='1')}`" for p in one.parameters)
                + (" and `cable`" if one.takes_cable else ""),
                one.law.replace("|", "\\|"),
                ", ".join(NEEDS[need] for need in sorted(one.needs)),
                one.source,
            )
            for one in SHIPPED.effects
        ),
        ("effect", "parameters", "law", "needs", "source"),
    )


def verdicts():
    """What may become of a pose."""
    rows = ((f"`{verdict.label}`", verdict.sentence) for verdict in Verdict)
    return _table(rows, ("verdict", "meaning"))


def commands_page():
    """Every command with its arguments and options, as `--help` has them."""
    return "\n".join(_command(get_command(commands), "designer"))


def _command(command, path):
    yield f"## `{path}`\n" if getattr(command, "commands", None) else f"### `{path}`\n"
    yield f"{_help(command.help or '')}\n"
    rows = [
        (_name(one), (getattr(one, "help", "") or "").replace("|", "\\|"))
        for one in command.params
        if one.name != "help"
    ]
    if rows:
        yield _table(rows, ("argument", "meaning"))
    for name in command.list_commands(None) if hasattr(command, "commands") else ():
        yield from _command(command.commands[name], f"{path} {name}")


def _help(text):
    """Return a help text; its examples as code."""
    return re.sub(r"^(.*?):  (designer .*)$", r"\1: `\2`", text, flags=re.MULTILINE)


def _name(parameter):
    metavar = parameter.metavar or ""
    if parameter.param_type_name == "argument":
        return f"`{metavar}`"
    return f"`{', '.join(parameter.opts)}{' ' + metavar if metavar else ''}`"


def nomenclature():
    """The table that closes every report."""
    path = data_folder("reports") / "report" / "nomenclature.html.j2"
    return f"```{{raw}} html\n{path.read_text(encoding='utf-8')}\n```"


def pairs():
    """Return what becomes of each option of a study with each of the others."""
    with PAIRS.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    names = dict.fromkeys(name for row in rows for name in (row["first"], row["second"]))
    numbers = {why: number for number, why in enumerate(dict.fromkeys(_whys(rows)), 1)}
    counts = Counter(row["outcome"] for row in rows)
    total = ", ".join(f"{count} {kind}" for kind, count in counts.most_common())
    table = _table((_of_option(name, rows, numbers) for name in names), PAIRS_HEAD)
    reasons = "\n".join(f"{number}. {why}" for why, number in numbers.items())
    return f"{len(rows)} pairs: {total}.\n\n{table}\n{reasons}\n"


def _whys(rows):
    return (row["why"] for row in rows if row["why"])


def _of_option(name, rows, numbers):
    """Return a row: the option, how often it is computed, and with what it is not."""
    own = [row for row in rows if name in (row["first"], row["second"])]

    def others(kind):
        each = (
            f"`{row['second' if row['first'] == name else 'first']}` ({numbers[row['why']]})"
            for row in own
            if row["outcome"] == kind
        )
        return ", ".join(each)

    computed = sum(row["outcome"] == "computed" for row in own)
    return f"`{name}`", str(computed), others("refused"), others("not covered")


def verification():
    """Return figures of others beside ours, as `designer verify` writes them; warn if one fails."""
    computed = compute()
    for case, figures in computed:
        for one in figures:
            if not one.holds:
                _LOGGER.warning("%s, %s: %s beside %s", case.title, one.name, one.ours, one.theirs)
    return markdown(computed)


WRITERS = {
    "verification": verification,
    "gallery": lambda: gallery.page(GALLERY),
    "pairs": pairs,
    "config": config,
    "effects": effects,
    "verdicts": verdicts,
    "commands": commands_page,
    "nomenclature": nomenclature,
}
