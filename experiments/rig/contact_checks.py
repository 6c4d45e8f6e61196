"""Warnings of touches that no impact law describes: a restitution above 1, a long duration, a deep overlap."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from pounding.contact.rubber import FLAT, RubberBlock
from pounding.experiments.rig.contact_history import ContactHistory
from pounding.experiments.rig.impacts import THRESHOLD_N
from pounding.experiments.rig.motion import Motion
from pounding.experiments.rig.touches import Touch, touches_of

LONGEST_SHARE = 0.1
"""A touch longer than this share of the shorter first period is part of the sway, not an impact [-]."""

DEEPEST_SHARE = 0.1
"""Floors that overlap by more than this share of the gap are softer than the gap allows [-]."""

SLOWEST_SHARE = 0.05
"""A touch approached slower than this share of the run's fastest has no restitution of its own: the frames' sway parts the
floors [-]."""


def contact_warnings(motion: Motion) -> list[str]:
    """Return a sentence for each limit of an impact that touches pass, with the worst of them.

    Args:
        motion: A run with contacts.
    """
    flat = [_flattened(history) for history in motion.contacts if isinstance(history.law, RubberBlock)]
    touches = [
        touch
        for history in motion.contacts
        if not isinstance(history.law, RubberBlock)  # which is meant to be soft, slow and deep
        for touch in touches_of(history)
        if touch.peak_force_n >= THRESHOLD_N
    ]
    if not touches:
        return [*filter(None, flat), *_in_the_middle(motion)]
    period = min(1.0 / float(frame.reduced.frequencies_hz[0]) for frame in motion.frames)
    fastest = max(touch.approach_m_s for touch in touches)
    return [
        *filter(None, flat),
        *_beyond(touches, lambda touch: _bounce(touch, SLOWEST_SHARE * fastest), 1.0, _bouncing),
        *_beyond(touches, lambda touch: touch.duration_s / period, LONGEST_SHARE, _lasting(period)),
        *_beyond(touches, _overlap, DEEPEST_SHARE, _sinking),
        *_in_the_middle(motion),
    ]


def _in_the_middle(motion: Motion) -> Iterable[str]:
    """Return a sentence on each pair of floors that turn and can touch in the middle of their edge alone."""
    turning = {frame.name for frame in motion.frames if frame.reduced.turns}
    places: dict[tuple[str, str, float], list[float]] = {}
    for one in motion.contacts:
        places.setdefault((one.left, one.right, one.floor), []).append(one.y_m)
    for (left, right, floor), found in places.items():
        if turning & {left, right} and found == [0.0] and float(floor).is_integer():
            yield (
                f"floors turn, and {left} and {right} can touch on floor {floor:g} of {left} in the middle of the edge "
                "alone (at an end they meet earlier); give several places as y_m in a street file"
            )


def _flattened(history: ContactHistory) -> str:
    """Return the sentence on a bumper that is pressed flat; empty for one that is not."""
    law = history.law
    deepest = int(history.deformation_m.argmax())
    share = float(history.deformation_m[deepest]) / law.thickness_m if isinstance(law, RubberBlock) else 0.0
    if share <= FLAT:
        return ""
    return (
        f"the bumper between {history.left} and {history.right} is compressed by {100 * share:.0f} % of its thickness at "
        f"{history.time_s[deepest]:.3f} s and counts as flat from {100 * FLAT:.0f} % on; give a thicker or a larger one"
    )


def _beyond(
    touches: Sequence[Touch],
    measure: Callable[[Touch], float],
    limit: float,
    words: Callable[[Touch], str],
) -> list[str]:
    """Return a sentence on the touches whose measure passes a limit, with the words on the worst; none if none does."""
    beyond = [touch for touch in touches if measure(touch) > limit]
    if not beyond:
        return []
    worst = max(beyond, key=measure)
    have = "has" if len(beyond) == 1 else "have"
    return [f"{len(beyond)} of {len(touches)} touches {have} {words(worst)}"]


def _bounce(touch: Touch, slowest_m_s: float) -> float:
    return (touch.restitution or 0.0) if touch.approach_m_s > slowest_m_s else 0.0


def _overlap(touch: Touch) -> float:
    return touch.depth_m / touch.gap_m if touch.gap_m > 0.0 else 0.0


def _bouncing(worst: Touch) -> str:
    return (
        f"a restitution above 1, up to {worst.restitution:.2f} {_where(worst)}: the sway of the frames parts those floors, "
        "not the contact, and the law's restitution says nothing of them"
    )


def _lasting(period_s: float) -> Callable[[Touch], str]:
    return lambda worst: (
        f"a duration above {LONGEST_SHARE:g} of the shorter first period of {period_s:.3g} s, up to "
        f"{1e3 * worst.duration_s:.3g} ms {_where(worst)}: the floors lean on each other there, or the contact is too soft "
        "to be an impact"
    )


def _sinking(worst: Touch) -> str:
    return (
        f"an overlap above {DEEPEST_SHARE:g} of the gap, up to {1e3 * worst.depth_m:.3g} mm of {1e3 * worst.gap_m:.4g} mm "
        f"{_where(worst)}: the contact is too soft for this gap, or the gap too small to tell from none; give a stiffer "
        "contact, or 0 for floors that lie against each other"
    )


def _where(touch: Touch) -> str:
    return f"at {touch.first_s:.3f} s on floor {touch.floor} of {touch.left} (against {touch.right})"
