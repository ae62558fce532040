"""Brings the effects of all plugins together."""

from __future__ import annotations

from designer.effects.checks import find_flaw
from designer.effects.guard import guarded
from designer.effects.kind import EffectKind
from designer.effects.known import KnownEffects
from designer.plugins.find import OWN_NAMES, Offer, Plugins, ask
from designer.plugins.guard import attempt, one_line


def load_effects(plugins: Plugins) -> KnownEffects:
    """Return our own effects and those of the plugins, ours first.

    A plugin that fails, or an effect that is faulty, is left out and reported in ``problems``.
    """
    offers, failures = ask(plugins, "register_effects")
    shelf = _Shelf([*plugins.problems, *failures])
    for offer in offers:
        shelf.add(offer)
    return KnownEffects(tuple(shelf.kinds.values()), tuple(shelf.problems))


class _Shelf:
    """The effects while they are being collected."""

    def __init__(self, problems: list[str]) -> None:
        self.problems = problems
        self.kinds: dict[str, EffectKind] = {}
        self._origins: dict[str, str] = {}

    def add(self, offer: Offer) -> None:
        """Add what is sound in an offer; report the rest."""
        for item in offer.items:
            if not isinstance(item, EffectKind):
                given = type(item).__name__
                self._leave_out(offer, f"register_effects() gave {given}, not an EffectKind")
            else:
                self._add_kind(item, offer)

    def _add_kind(self, kind: EffectKind, offer: Offer) -> None:
        place = f"{offer.label}: {_named(kind)}"
        flaw = attempt(lambda: find_flaw(kind), place, "cannot be built", self.problems)
        if flaw is None:  # reported by then
            return
        if flaw:
            self._leave_out(offer, f"{_named(kind)}: {flaw}")
        elif kind.name.id in self.kinds:
            taken = f"is in {self._origins[kind.name.id]!r} already"
            self._leave_out(offer, f"{_named(kind)} {taken}")
        else:
            self._origins[kind.name.id] = offer.name
            is_own = offer.name in OWN_NAMES
            self.kinds[kind.name.id] = kind if is_own else guarded(kind, offer.label)

    def _leave_out(self, offer: Offer, problem: str) -> None:
        self.problems.append(f"{offer.label}: {one_line(problem)}: left out")


def _named(kind: EffectKind) -> str:
    return f"effect {one_line(repr(getattr(kind.name, 'id', kind.name)))}"
