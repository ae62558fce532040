"""Brings the effects of all plugins together."""

from __future__ import annotations

from designer.effects.checks import find_flaw
from designer.effects.effect import Effect
from designer.effects.guard import guarded
from designer.effects.known import KnownEffects
from designer.errors import one_line
from designer.plugins.find import OWN_NAMES, Offer, Plugins, ask
from designer.plugins.guard import attempt


def load_effects(plugins: Plugins) -> KnownEffects:
    """Return our own effects and those of the plugins, ours first.

    A plugin that fails, or an effect that is faulty, is left out and reported in ``problems``.
    """
    offers, failures = ask(plugins, "register_effects")
    problems = [*plugins.problems, *failures]
    origins: dict[str, str] = {}
    effects: list[Effect] = []
    for offer in offers:
        for item in offer.items:
            effect = _sound(item, offer, origins, problems)
            if effect is not None:
                origins[effect.id] = offer.name
                is_own = offer.name in OWN_NAMES
                effects.append(effect if is_own else guarded(effect, offer.label))
    return KnownEffects(tuple(effects), tuple(dict.fromkeys(problems)))


def _sound(
    item: object, offer: Offer, origins: dict[str, str], problems: list[str]
) -> Effect | None:
    """Return an effect that can be used; None, and a line in ``problems``, for another."""
    if not isinstance(item, Effect):
        name__ = type(item).__name__
        problems.append(f"{offer.label}: register_effects() gave {name__}, not an Effect: left out")
        return None
    named = f"{offer.label}: effect {one_line(repr(item.id))}"
    flaw = attempt(lambda: find_flaw(item), named, "cannot be built", problems)
    if flaw is None:  # reported by then
        return None
    if flaw:
        problems.append(f"{named}: {one_line(flaw)}: left out")
        return None
    if item.id in origins:
        problems.append(f"{named} is in {origins[item.id]!r} already: left out")
        return None
    return item
