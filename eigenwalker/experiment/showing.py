"""How walks are shown to observers."""

from dataclasses import dataclass

from eigenwalker._validation import check_choice
from eigenwalker.display._numbers import check_number
from eigenwalker.display.body import find_azimuth

__all__ = ["Showing"]

_FIGURES = ("dots", "sticks")
_ANSWERS = ("any", "after")


@dataclass(frozen=True, kw_only=True)
class Showing:
    """How walks are shown, the same in all trials of a task.

    Parameters
    ----------
    figure : {"dots", "sticks"}
        Point lights, white on black, or a stick figure.
    view : str or float, default "half-profile"
        Where the observer stands: "frontal", "half-profile", "side", or an azimuth in degrees.
    height : float, default None
        Degrees of visual angle that the body spans, for which the page asks how large its pixels are and how far away
        the observer sits. None is as large as the picture allows, without asking.
    dot_diameter : float, default 0.25
        Of point lights, in degrees where the height is in degrees; else a fortieth of the body's height each 0.25.
    duration : float, default None
        How long a walk is shown. None is as long as it is; in the papers 3 to 17 seconds.
    self_paced : bool, default True
        Whether the participant starts each walk, and plays it again at will.
    answer : {"any", "after"}, default "any"
        Whether an answer is taken as soon as all walks of a trial have begun, or after each has come to its end.
    blank : float, default 0.5
        Seconds of blank screen between trials.
    """

    figure: str = "sticks"
    view: str | float = "half-profile"
    height: float | None = None
    dot_diameter: float = 0.25
    duration: float | None = None
    self_paced: bool = True
    answer: str = "any"
    blank: float = 0.5

    def __post_init__(self) -> None:
        check_choice(self.figure, _FIGURES, name="figure")
        check_choice(self.answer, _ANSWERS, name="answer")
        check_number(find_azimuth(self.view), "view", unit="degrees")
        if self.height is not None:
            check_number(self.height, "height", above=0, at_most=90, unit="degrees of visual angle")
        check_number(self.dot_diameter, "dot_diameter", above=0, at_most=90, unit="degrees of visual angle")
        if self.duration is not None:
            check_number(self.duration, "duration", above=0, unit="seconds")
        check_number(self.blank, "blank", at_least=0, unit="seconds")
