"""What observers are asked: the five studies of the three papers, with the papers' numbers as defaults.

A task is a plain object: the words on its buttons and what they are worth, how walks are shown, and how many trials of
which kind a participant gets. All have the fields of `Showing`; times are in seconds, angles in degrees.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, fields
from typing import Any, ClassVar, NamedTuple

from eigenwalker._validation import check_choice
from eigenwalker.display._numbers import check_count, check_number
from eigenwalker.display.body import find_azimuth
from eigenwalker.experiment.showing import Showing
from eigenwalker.experiment.stimulus import AVERAGE, check_words

__all__ = [
    "DONT_KNOW",
    "RESEMBLANCE",
    "TASKS",
    "Button",
    "NaturalnessTask",
    "PairTask",
    "RatingTask",
    "RecognitionTask",
    "ResemblanceTask",
    "Task",
]

DONT_KNOW = "don't know"
"""The answer of those who cannot decide."""

RESEMBLANCE = ("nothing in common", "very different", "different", "slightly different", "identical")
"""The answers of the test of resemblance (Tilmanne, Moinet & Dutoit 2012, 6.4), worth 0 to 4."""

_SIDES = ("first", "second", "alternate")
_REFERENCES = ("left", "right", "random")
_DRAWS = ("random", "balanced")


class Button(NamedTuple):
    """What can be answered.

    Parameters
    ----------
    text : str
        On the button; may be empty.
    answer : str
        What stands in the table of answers.
    value : float or None
        The same as a number, if it is one.
    """

    text: str
    answer: str
    value: float | None


@dataclass(frozen=True)
class RatingTask:
    """How much of a trait each walker has (Troje 2002, section 4).

    Each walker is shown once in a session, in random order, all of a session from one viewpoint; the sessions' order is
    counterbalanced over the participants. Several rating tasks in one study are label groups: a participant is in one.

    Parameters
    ----------
    poles : (str, str), default ("sad", "happy")
        Words at the ends; ratings count towards the second, as everywhere in this package.
    trait : str, default ""
        What it is called in tables; "" is the second pole.
    n_buttons : int, default 6
        From pole to pole.
    left : {"second", "first", "alternate"}, default "second"
        Which pole stands at the leftmost button. The paper's text has "happy" there. "alternate" has one for every
        other participant of a group.
    views : sequence of str or float, default (0, 30, 90)
        Viewpoints, one a session.
    question, instruction : str
        Over the buttons, and before each session; None makes one of the poles.
    n_practice, n_attention : int, default 0
        Trials before the first session, of walkers at random; and trials in each session that ask for a given answer.
    showing : Showing
        Fifteen white dots on black, 5 degrees high, for 7 s, which run by themselves; 3 s of blank screen follow.

    Examples
    --------
    >>> from eigenwalker.experiment import RatingTask
    >>> [button.text for button in RatingTask(("relaxed", "nervous")).buttons]
    ['relaxed', '', '', '', '', 'nervous']
    """

    poles: tuple[str, str] = ("sad", "happy")
    trait: str = ""
    n_buttons: int = 6
    left: str = "second"
    views: Sequence[str | float] = (0.0, 30.0, 90.0)
    question: str | None = None
    instruction: str | None = None
    n_practice: int = 0
    n_attention: int = 0
    showing: Showing = field(
        default_factory=lambda: Showing(figure="dots", height=5.0, duration=7.0, self_paced=False, blank=3.0)
    )

    name: ClassVar[str] = "rating"
    is_pair: ClassVar[bool] = False

    def __post_init__(self) -> None:
        poles = check_words(self.poles, name="poles")
        if len(poles) != 2:
            raise ValueError(f"poles must be two words, ('sad', 'happy'), got {poles!r}")
        object.__setattr__(self, "poles", poles)
        (trait,) = check_words([str(self.trait) or poles[1]], name="trait")
        object.__setattr__(self, "trait", trait)
        object.__setattr__(self, "n_buttons", check_count(self.n_buttons, "n_buttons", at_least=2, at_most=100))
        check_choice(self.left, _SIDES, name="left")
        if isinstance(self.views, (str, float, int)) or not len(self.views):
            raise ValueError(f"views must be a sequence of one viewpoint or more, (0, 30, 90), got {self.views!r}")
        views = tuple(check_number(find_azimuth(view), "views", unit="degrees") for view in self.views)
        if len(set(views)) < len(views):
            raise ValueError(f"views must differ from each other, got {views}")
        object.__setattr__(self, "views", views)
        _check_extra(self)
        if self.showing.duration is None and not self.showing.self_paced:
            raise ValueError("showing.duration must be given where walks run by themselves, in seconds")

    @property
    def buttons(self) -> tuple[Button, ...]:
        """From the first pole to the second."""
        last = self.n_buttons
        words = {1: self.poles[0], last: self.poles[1]}
        return tuple(Button(words.get(step, ""), str(step), float(step)) for step in range(1, last + 1))

    @property
    def words(self) -> tuple[str, str]:
        """Question, and instruction."""
        low, high = self.poles
        return (
            f"How does this walker seem to you, {low} or {high}?" if self.question is None else self.question,
            f"You will see people walking, shown as moving dots. For each, press one of the {self.n_buttons} buttons: "
            f"the nearer to “{high}” or “{low}”, the more the walker seems so to you. Go by your first impression. "
            "There are no right or wrong answers."
            if self.instruction is None
            else self.instruction,
        )


@dataclass(frozen=True)
class PairTask:
    """How natural a synthetic walk is beside its original (Tilmanne & Dutoit 2012, section 3).

    Parameters
    ----------
    n_series : int, default 3
        Runs of trials, with breaks between them.
    n_trials : int, default 15
        Of a series. Each pair is shown to a participant once at most: where there are fewer pairs than trials, the last
        series are shorter.
    scale : sequence of str, default ("not realistic", "", "", "", "as natural as the original")
        Words of 0, 1, ...; "" leaves the number alone on its button.
    reference : {"left", "right", "random"}, default "left"
        Where the original stands, which is marked as such. The paper does not say.
    question, instruction : str
        Below the walks, and before each series.
    draw : {"random", "balanced"}, default "random"
        Which pairs a participant gets: drawn anew for each, as in the paper, or dealt out, so that all are judged
        equally often.
    n_practice, n_attention : int, default 0
        See `RatingTask`.
    showing : Showing
        Stick figures, started and replayed at will.
    """

    n_series: int = 3
    n_trials: int = 15
    scale: Sequence[str] = ("not realistic", "", "", "", "as natural as the original")
    reference: str = "left"
    question: str = "How natural is the other walk, compared to the original?"
    instruction: str = (
        "You will see pairs of walks. One is the original, recorded from an actor, and is marked as such; the other "
        "was made by a computer. Click on a walk to start it; you may play each as often as you want. Then say how "
        "natural the computer's walk is, from 0, not realistic, to 4, as natural as the original."
    )
    draw: str = "random"
    n_practice: int = 0
    n_attention: int = 0
    showing: Showing = field(default_factory=Showing)

    name: ClassVar[str] = "pair"
    is_pair: ClassVar[bool] = True
    trait: ClassVar[str] = ""

    def __post_init__(self) -> None:
        _check_drawn(self)
        check_choice(self.reference, _REFERENCES, name="reference")
        if isinstance(self.scale, str) or len(self.scale) < 2:
            raise ValueError(f"scale must be a sequence of two words or more, '' for none, got {self.scale!r}")
        object.__setattr__(self, "scale", tuple(str(word) for word in self.scale))

    @property
    def buttons(self) -> tuple[Button, ...]:
        """From the worst to the best."""
        return tuple(Button(f"{step} {word}".strip(), str(step), float(step)) for step, word in enumerate(self.scale))

    @property
    def words(self) -> tuple[str, str]:
        """Question, and instruction."""
        return self.question, self.instruction


@dataclass(frozen=True)
class NaturalnessTask:
    """Whether a walk is real or synthetic (Tilmanne, Moinet & Dutoit 2012, 6.2).

    The paper asked first whether walks are "natural": of acted, exaggerated styles nearly none seemed so.

    Parameters
    ----------
    n_trials : int, default 10
        Of a participant, drawn from all stimuli.
    question, instruction : str
        Below the walk, and before the first.
    draw, n_practice, n_attention, showing
        See `PairTask`.
    """

    n_trials: int = 10
    question: str = "Does this walk seem real or synthetic?"
    instruction: str = (
        "You will see one walk at a time. Some were recorded from an actor, who often exaggerated; others were made by "
        "a computer. Click on the walk to start it; you may play it as often as you want. Then say whether it seems "
        "real, recorded from a person, or synthetic, made by a computer."
    )
    draw: str = "random"
    n_practice: int = 0
    n_attention: int = 0
    showing: Showing = field(default_factory=Showing)

    name: ClassVar[str] = "naturalness"
    is_pair: ClassVar[bool] = False
    trait: ClassVar[str] = ""
    n_series: ClassVar[int] = 1

    def __post_init__(self) -> None:
        _check_drawn(self)

    @property
    def buttons(self) -> tuple[Button, ...]:
        """Real, synthetic, and the third."""
        return Button("real", "real", None), Button("synthetic", "synthetic", None), _dont_know()

    @property
    def words(self) -> tuple[str, str]:
        """Question, and instruction."""
        return self.question, self.instruction


@dataclass(frozen=True)
class RecognitionTask:
    """Which style a walk is in (Tilmanne, Moinet & Dutoit 2012, 6.3).

    Parameters
    ----------
    styles : sequence of str, default ()
        The styles to choose from, to which "average walk" and "I don't know" are added: 13 answers with the paper's
        11 styles. () takes those of the stimuli, sorted.
    n_trials : int, default 10
        Of a participant, drawn from all stimuli.
    question, instruction : str
        Below the walk, and before the first.
    draw, n_practice, n_attention, showing
        See `PairTask`.
    """

    styles: Sequence[str] = ()
    n_trials: int = 10
    question: str = "Which style is this walk in?"
    instruction: str = (
        "You will see one walk at a time, each in one of several styles. Click on the walk to start it; you may play "
        "it as often as you want. Then choose the style that fits best. An average walk is in no particular style."
    )
    draw: str = "random"
    n_practice: int = 0
    n_attention: int = 0
    showing: Showing = field(default_factory=Showing)

    name: ClassVar[str] = "recognition"
    is_pair: ClassVar[bool] = False
    trait: ClassVar[str] = ""
    n_series: ClassVar[int] = 1

    def __post_init__(self) -> None:
        _check_drawn(self)
        styles = check_words(self.styles, name="styles")
        taken = sorted({AVERAGE, DONT_KNOW} & set(styles))
        if taken:
            raise ValueError(f"styles must be without those that are always there, got {', '.join(taken)}")
        object.__setattr__(self, "styles", styles)

    @property
    def buttons(self) -> tuple[Button, ...]:
        """The styles, and two more."""
        return (*(Button(style, style, None) for style in (*self.styles, AVERAGE)), _dont_know())

    @property
    def words(self) -> tuple[str, str]:
        """Question, and instruction."""
        return self.question, self.instruction


@dataclass(frozen=True)
class ResemblanceTask:
    """How much a synthetic walk resembles its original (Tilmanne, Moinet & Dutoit 2012, 6.4).

    Parameters
    ----------
    n_trials : int, default 10
        Of a participant, drawn from all pairs. Which of the two stands left is random, and neither is marked.
    question, instruction : str
        Below the walks, and before the first.
    draw, n_practice, n_attention, showing
        See `PairTask`.
    """

    n_trials: int = 10
    question: str = "How much do these two walks resemble each other?"
    instruction: str = (
        "You will see two walks at a time. Click on a walk to start it; you may play each as often as you want. Then "
        "say how much they resemble each other, from identical to nothing in common."
    )
    draw: str = "random"
    n_practice: int = 0
    n_attention: int = 0
    showing: Showing = field(default_factory=Showing)

    name: ClassVar[str] = "resemblance"
    is_pair: ClassVar[bool] = True
    trait: ClassVar[str] = ""
    n_series: ClassVar[int] = 1
    reference: ClassVar[str] = "random"

    def __post_init__(self) -> None:
        _check_drawn(self)

    @property
    def buttons(self) -> tuple[Button, ...]:
        """From identical, worth 4, to nothing in common, worth 0."""
        worth = list(enumerate(RESEMBLANCE))
        return tuple(Button(words, words, float(value)) for value, words in reversed(worth))

    @property
    def words(self) -> tuple[str, str]:
        """Question, and instruction."""
        return self.question, self.instruction


Task = RatingTask | PairTask | NaturalnessTask | RecognitionTask | ResemblanceTask

TASKS: dict[str, Any] = {
    task.name: task for task in (RatingTask, PairTask, NaturalnessTask, RecognitionTask, ResemblanceTask)
}
"""The tasks by their names in tables."""


def _dont_know() -> Button:
    return Button("I don't know", DONT_KNOW, None)


def _check_drawn(task: Any) -> None:
    for name in ("n_series", "n_trials"):
        value = check_count(getattr(task, name), name, at_least=1)
        if name in {one.name for one in fields(task)}:
            object.__setattr__(task, name, value)
    check_choice(task.draw, _DRAWS, name="draw")
    _check_extra(task)


def _check_extra(task: Any) -> None:
    for name in ("n_practice", "n_attention"):
        object.__setattr__(task, name, check_count(getattr(task, name), name))
    if not isinstance(task.showing, Showing):
        raise TypeError(f"showing must be a Showing, got {type(task.showing).__name__}")
