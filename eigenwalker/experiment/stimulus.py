"""What observers are shown: walks, and what is known of them."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from unicodedata import category

from eigenwalker._validation import check_choice, check_names, check_walks
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = ["AVERAGE", "CONDITIONS", "KINDS", "Stimulus", "as_stimuli", "check_words", "cross_stimuli"]

AVERAGE = "average walk"
"""The style of what an average model makes, and the answer that is right for it."""

KINDS = ("original", "synthetic")
"""The kinds of walks."""

CONDITIONS = ("static", "displacement")
"""In place, or on the way over the floor (Tilmanne, Moinet & Dutoit 2012, 6.1)."""

_CONTROLS = ("Cc", "Zl", "Zp")  # categories of letters that end lines, or are none
_Walks = Walk | JointWalk | Sequence[Walk | JointWalk]


@dataclass(frozen=True, eq=False)
class Stimulus:
    """A walk, or a movie, that observers are shown under a name of its own.

    Parameters
    ----------
    name : str
        By which designs and answers know it.
    walk : Walk or JointWalk, default None
        Prepared or synthetic. Of a skeleton whose markers are known by their names.
    movie : str or path, default None
        An MP4 file to be shown in place of a walk.
    style : str, default ""
        What is true of it.
    kind : {"", "original", "synthetic"}, default ""
        Where it comes from.
    condition : {"", "static", "displacement"}, default ""
        How a walk is shown: with its pelvis over one place, or on its way over the floor. "" shows the harmonics of a
        walk in place, as point-light displays are.
    reference : str, default ""
        Name of the stimulus that it is compared with, its original.

    Raises
    ------
    TypeError, ValueError
        If it has no name, both a walk and a movie, or an unknown kind or condition.
    """

    name: str
    walk: Walk | JointWalk | None = None
    movie: str | os.PathLike[str] | None = None
    style: str = ""
    kind: str = ""
    condition: str = ""
    reference: str = ""

    def __post_init__(self) -> None:
        check_words([self.name], name="name of a stimulus")
        if self.style:
            check_words([self.style], name=f"stimulus {self.name!r}: style")
        check_choice(self.kind, ("", *KINDS), name=f"stimulus {self.name!r}: kind")
        check_choice(self.condition, ("", *CONDITIONS), name=f"stimulus {self.name!r}: condition")
        if self.walk is not None and self.movie is not None:
            raise ValueError(f"stimulus {self.name!r}: expected a walk or a movie, got both")
        if self.walk is not None and not isinstance(self.walk, (Walk, JointWalk)):
            raise TypeError(f"stimulus {self.name!r}: expected a Walk or JointWalk, got {type(self.walk).__name__}")
        if self.movie is not None and Path(self.movie).suffix.lower() != ".mp4":
            raise ValueError(f"stimulus {self.name!r}: expected a movie that ends in .mp4, got {Path(self.movie).name}")


def check_words(words: Iterable[str], *, name: str) -> tuple[str, ...]:
    """Return words that can stand in one line of a table, different from each other; see `check_names`."""
    checked = check_names(words, name=name)
    broken = [word for word in checked if any(category(letter) in _CONTROLS and letter != "\t" for letter in word)]
    if broken:
        raise ValueError(f"{name} must be without line breaks and other control characters, got {broken[0]!r}")
    return checked


def as_stimuli(walks: Sequence[Walk | JointWalk | Stimulus]) -> tuple[Stimulus, ...]:
    """Return stimuli, of walks those with the walks' names.

    Parameters
    ----------
    walks : list of Walk, JointWalk or Stimulus
        With names of their own.

    Raises
    ------
    TypeError, ValueError
        If there are none, others than these, names that are empty or repeat, or references to what is not among them.
    """
    listed = check_walks(walks, kind=(Walk, JointWalk, Stimulus))
    stimuli = tuple(walk if isinstance(walk, Stimulus) else Stimulus(walk.name or "", walk) for walk in listed)
    known = set(check_names([stimulus.name for stimulus in stimuli], name="names of walks"))
    lost = sorted({stimulus.reference for stimulus in stimuli} - known - {""})
    if lost:
        raise ValueError(f"expected references among the stimuli, these are not: {', '.join(lost)}")
    return stimuli


def cross_stimuli(
    originals: Mapping[str, _Walks],
    synthetics: Mapping[str, _Walks],
    *,
    average: Walk | JointWalk | None = None,
    conditions: Sequence[str] = CONDITIONS,
) -> list[Stimulus]:
    """Return original and synthetic walks of each style, each in place and on its way: those of all three tests.

    With the paper's 11 styles, one walk of each, and the walk of the average model, these are 44 + 2 (Tilmanne, Moinet
    & Dutoit 2012, 6.1). A synthetic walk refers to the original of its style that is shown under the same condition.

    Parameters
    ----------
    originals, synthetics : mapping of str to Walk, JointWalk or list of them
        Walks of each style. A style has as many synthetic walks as original ones, which are then compared in this
        order, or one original that all of them are compared with.
    average : Walk or JointWalk, default None
        What the average model makes; it is of the style "average walk" and has no original.
    conditions : sequence of {"static", "displacement"}, default both
        For a single walk to be shown on its way it must travel, or its `speed` must be known.

    Returns
    -------
    list of Stimulus
        Named ``sad_original_static`` and so on, from 1 where a style has several.

    Raises
    ------
    TypeError, ValueError
        If there are no walks, a synthetic walk has no original, or numbers of walks do not fit.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.experiment import cross_stimuli
    >>> sad, cool, made = make_walkers(3, random_state=0).data
    >>> stimuli = cross_stimuli({"sad": sad, "cool": cool}, {"sad": made, "cool": made})
    >>> len(stimuli), stimuli[2].name, stimuli[2].reference
    (8, 'sad_synthetic_static', 'sad_original_static')
    """
    recorded, made = _by_style(originals, "originals"), _by_style(synthetics, "synthetics")
    _check_counts(recorded, made)
    for condition in conditions:
        check_choice(condition, CONDITIONS, name="conditions")
    stimuli = []
    for style, walks in recorded.items():
        for kind, series in (("original", walks), ("synthetic", made.get(style, []))):
            for number, walk in enumerate(series):
                own = "" if len(series) == 1 else f"_{number + 1}"
                against = "" if len(walks) == 1 else f"_{number + 1}"
                stimuli += [
                    Stimulus(
                        f"{style}_{kind}{own}_{condition}",
                        walk,
                        style=style,
                        kind=kind,
                        condition=condition,
                        reference=f"{style}_original{against}_{condition}" if kind == "synthetic" else "",
                    )
                    for condition in conditions
                ]
    if average is not None:
        stimuli += [
            Stimulus(f"average_{condition}", average, style=AVERAGE, kind="synthetic", condition=condition)
            for condition in conditions
        ]
    return stimuli


def _by_style(series: object, name: str) -> dict[str, list[Walk | JointWalk]]:
    if not isinstance(series, Mapping):
        raise TypeError(f"{name} must be a mapping of styles to walks, {{'sad': walk}}, got {type(series).__name__}")
    return {str(style): _listed(walks) for style, walks in series.items()}


def _listed(walks: _Walks) -> list[Walk | JointWalk]:
    return check_walks([walks] if isinstance(walks, (Walk, JointWalk)) else walks, kind=(Walk, JointWalk))


def _check_counts(originals: Mapping[str, list], synthetics: Mapping[str, list]) -> None:
    if not originals:
        raise ValueError("expected original walks of at least one style, got none")
    alone = sorted(set(synthetics) - set(originals))
    if alone:
        raise ValueError(f"expected an original of each style that was synthesized, none of: {', '.join(alone)}")
    odd = [
        f"{style} ({len(originals[style])} and {len(walks)})"
        for style, walks in synthetics.items()
        if len(originals[style]) not in (1, len(walks))
    ]
    if odd:
        raise ValueError(f"expected one original of a style, or as many as synthetic walks, got {', '.join(odd)}")
