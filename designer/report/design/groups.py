"""Products for groups of cables: what each gets, what it saves, what is proved, what was tried."""

from __future__ import annotations

from designer.analysis.analyse import Analysis
from designer.arrays import FloatArray
from designer.report import format as fmt
from designer.report.blocks import (
    Column,
    Fact,
    Facts,
    Heads,
    Picture,
    Row,
    Section,
    Statement,
    Subheading,
    Table,
)
from designer.report.design.source import Source
from designer.report.pictures import chart
from designer.selection.assignment import Assignment
from designer.selection.groups.result import GroupChoice, TriedAssignment

_MOST_ROWS = 12


def section(source: Source) -> Section | None:
    """Return what each group gets; None if the study has no groups."""
    choice = source.analysis.groups
    if choice is None:
        return None
    return Section.of(
        "groups",
        "Products for groups of cables",
        groups_statement(choice),
        _facts(choice),
        _chosen(choice.chosen) if choice.chosen.is_found else None,
        _plan(source.analysis) if source.draws and choice.chosen.is_found else None,
        Subheading("proposals", "How they were found"),
        _how(choice),
        _proposals(choice) if choice.proposals else None,
    )


def _plan(analysis: Analysis) -> Picture:
    from designer.report.figures.groups_plan import groups_plan

    workspace = analysis.study.workspace
    assert workspace is not None
    return chart(
        "The robot from above. Cables are drawn as thick as they are to each other.",
        "Lines from the exit points to the platform, one colour a group",
        groups_plan(analysis.built.robot, workspace.region, analysis.assignment),
    )


def groups_statement(choice: GroupChoice) -> Statement:
    """Return what was found for the groups, and what it saves."""
    if not choice.chosen.is_found:
        return Statement("No products were found for the groups", choice.proof_sentence, "bad")
    distinct = len(choice.chosen.products)
    text = f"{fmt.plural(len(choice.groups), 'group')} with {fmt.plural(distinct, 'product')}"
    if choice.saving_kg is None:
        return Statement("Products were found for the groups", f"{text}.", "good")
    share = choice.saving_kg / choice.single.total_mass_kg
    if abs(share) < 1e-9:
        text = "One product for all cables is best; different ones save nothing."
        return Statement("The groups need no products of their own", text)
    word = "less" if share > 0.0 else "more"
    text += (
        f" weigh {fmt.kilograms(abs(choice.saving_kg))} ({fmt.percent(abs(share))}) {word} than "
        "the best single product for all cables."
    )
    return Statement("Products were found for the groups", text, "good")


def groups_hold(assignment: Assignment) -> str:
    """Return which ropes hold together, and how much they are used."""
    each = [
        f"{rope.label} for {group.name}"
        for group, rope in zip(assignment.groups, assignment.ropes, strict=True)
    ]
    if len(assignment.products) == 1:
        each = [f"Ropes of {assignment.ropes[0].label} for all groups"]
    most = float(assignment.verification.utilisation.max())
    tight = " There is hardly any reserve beyond it." if most > 0.97 else ""
    return (
        f"{fmt.listing(each)} hold every pose of the workspace together. The most used of them "
        f"reaches {fmt.utilisation(most)} of what the safety factor allows.{tight}"
    )


def _facts(choice: GroupChoice) -> Facts:
    limit = fmt.plural(choice.most_distinct, "product")
    facts = [Fact("Different products", f"at most {limit}")]
    if choice.chosen.is_found:
        facts.append(Fact("All cables", fmt.kilograms(choice.chosen.total_mass_kg)))
    if choice.objective == "cost" and choice.total is not None:
        facts.append(Fact("Cost", f"{fmt.number(choice.total)} {choice.unit}"))
    if choice.single.is_found:
        facts.append(Fact("One product for all", fmt.kilograms(choice.single.total_mass_kg)))
    if choice.gap is not None:
        unit = f"{fmt.number(choice.bound)} {choice.unit}"
        facts.append(Fact("Bound", f"{unit}, gap {fmt.percent(choice.gap)}"))
    proof = {"optimal": "best", "stopped": "not finished", "infeasible": "none holds"}
    facts.append(Fact("Proof", proof[choice.proof], choice.proof_sentence))
    return Facts(tuple(facts))


def _chosen(chosen: Assignment) -> Table:
    found = chosen.verification
    decimals = fmt.decimals(one.cable.allowable_tension_N / 1e3 for one in chosen.ropes)
    rows = [
        Row(
            (
                group.name,
                ", ".join(str(cable) for cable in group.cables),
                product.label,
                fmt.fixed(1e3 * product.size.diameter_m, 1),
                fmt.fixed(product.cable.linear_density_kg_per_m, 3),
                fmt.fixed(product.cable.allowable_tension_N / 1e3, decimals),
                fmt.utilisation(float(found.utilisation[k])),
                _place(found.worst_place[k]),
            ),
            note=fmt.doubtful(product.size.doubt),
        )
        for k, (group, product) in enumerate(zip(chosen.groups, chosen.ropes, strict=True))
    ]
    caption = (
        "What each group gets. All cables together were verified over the whole workspace, each "
        "with its own mass, stiffness and breaking load, and each group's worst pose was searched "
        "between the samples."
    )
    columns = (
        *("Group", "Cables", "Product", Column("Diameter", "mm"), Column("Mass", "kg/m")),
        *(Column("Allowable", "kN"), Column("Used"), Column("Most at", "m", is_number=False)),
    )
    return Table.of(caption, columns, *rows)


def _place(place: FloatArray) -> str:
    numbers = ", ".join(f"{value:.4g}" for value in place[:3])
    return f"({numbers})".replace("-", "\N{MINUS SIGN}")


def _how(choice: GroupChoice) -> str:
    steps = (
        f"A mixed-integer programme proposes the assignment with the least {choice.objective} that "
        "nothing speaks against; it is then solved with all its cables. "
    )
    if choice.by_balance:
        steps += (
            "The balance of forces in the worst poses met so far is part of the programme, with a "
            "catenary's forces held between bounds that every cable obeys. "
        )
    if choice.by_weight:
        steps += (
            "With three cables on a point mass a heavier or stiffer cable raises the tension of "
            "every other one, so what overloads a cable excludes all heavier company with it. "
        )
    return (
        f"{steps}A product is offered if no other one is at once as light, as soft and as strong: "
        f"{fmt.count(choice.offered)} of {fmt.count(choice.catalogued)}."
    )


def _proposals(choice: GroupChoice) -> Table:
    shown = choice.proposals[:_MOST_ROWS]
    more = len(choice.proposals) - len(shown)
    caption = "Assignments that were tried, in order, after one product for all."
    if more:
        caption += f" {fmt.plural(more, 'more')} are in result.json."
    names = (group.name for group in choice.groups)
    numbers = Column("At least", choice.unit), Column("Excluded")
    columns: Heads = (Column("No."), *names, *numbers, "Outcome")
    rows = (_row(k, one, choice) for k, one in enumerate(shown, start=1))
    return Table.of(caption, columns, *rows, kind="long")


def _row(number: int, one: TriedAssignment, choice: GroupChoice) -> Row:
    cells = (
        str(number),
        *(product.size.id for product in one.products),
        fmt.number(one.bound),
        fmt.count(one.excluded) if one.outcome != "holds" else fmt.MISSING,
        _outcome(one, choice),
    )
    is_chosen = one.products == choice.chosen.ropes
    return Row(cells, "good" if is_chosen else "muted" if one.outcome != "holds" else "")


def _outcome(one: TriedAssignment, choice: GroupChoice) -> str:
    if one.outcome == "holds":
        assert one.total is not None
        return f"holds: {fmt.number(one.total)} {choice.unit}"
    if one.outcome == "not_better":
        return "no better with the lengths that it needs"
    assert one.group is not None
    assert one.place is not None
    name = choice.groups[one.group].name
    if one.utilisation is None or one.utilisation == float("inf"):
        return f"not held at {_place(one.place)}"
    return f"{name} {fmt.utilisation(one.utilisation)} at {_place(one.place)}"
