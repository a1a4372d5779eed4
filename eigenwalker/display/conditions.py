"""A display from one flat set of parameters, such as a row of a table of conditions."""

from collections.abc import Sequence
from typing import Literal

import numpy as np
from sklearn.utils import check_random_state

from eigenwalker._validation import check_choice
from eigenwalker.display.stimuli import PointLightDisplay
from eigenwalker.motion.walk import Walk

__all__ = ["make_display"]

_INVERSIONS = ("none", "whole", "local")
_STEPS = ("position", "phase", "period", "mask", "lifetime")


def make_display(
    walk: Walk,
    *,
    n_harmonics: int = 4,
    markers: Sequence[str] | None = None,
    view: str | float = "side",
    elevation: float = 0.0,
    height: float | None = None,
    distance: float | None = None,
    dot_diameter: float = 0.25,
    polarity: Literal["light", "dark"] = "light",
    inversion: Literal["none", "whole", "local"] = "none",
    scramble_position: float = 0.0,
    scramble_how: str = "area",
    scramble_phase: float = 0.0,
    scramble_period: float = 0.0,
    start_phase: float = 0.0,
    translating: bool = False,
    speed: float | None = None,
    start_ahead: float = 0.0,
    n_mask_dots: int = 0,
    mask_width: float | None = None,
    mask_height: float | None = None,
    n_visible: int | None = None,
    lifetime: float | None = None,
    random_state: int | np.random.RandomState | None = None,
) -> PointLightDisplay:
    """Return the display of a walk under a condition.

    The steps are the methods of `PointLightDisplay`, in this order: view and size, inversion, scrambling of position,
    phase and period, translation, mask, lifetime. So a mask is made of inverted dots, and of scrambled ones; it
    travels with a walker that does; and the dots of limited lifetime are those of walker and mask together. For another
    order, call the methods.

    Parameters
    ----------
    walk : Walk
        In place, from `prepare`, from a model, or from `hybrid_walk`.
    n_harmonics : int, default 4
        Number of harmonics that are kept.
    markers : sequence of str, default None
        Those that become dots, also as one string with spaces between them. None takes all.
    view, elevation : str or float, default "side", and float, default 0.0
        Where the observer stands, see `seen_from`.
    height, distance : float, default None
        Degrees of visual angle that the walker spans, or metres from which it is seen in life size; see `sized`. None
        for both is 10 degrees.
    dot_diameter : float, default 0.25
        In degrees of visual angle.
    polarity : {"light", "dark"}, default "light"
        Light dots on dark, or dark dots on light.
    inversion : {"none", "whole", "local"}, default "none"
        See `inverted`.
    scramble_position, scramble_phase, scramble_period : float, default 0.0
        Amounts, see the methods of that name.
    scramble_how : str, default "area"
        Directions of `scramble_position`.
    start_phase : float, default 0.0
        In strides, see `starting_at`.
    translating : bool, default False
        Whether the walker moves over the floor.
    speed, start_ahead : float, default None and 0.0
        In m/s and in metres, see `translating`.
    n_mask_dots : int, default 0
        Number of mask dots, scrambled wholly in position and phase.
    mask_width, mask_height : float, default None
        Of the area that the mask's paths stay in, in metres. None takes the rectangle that the dots cover.
    n_visible, lifetime : int and float, default None
        How many dots are lit at a time, and for how long, in seconds. None lights all.
    random_state : int, RandomState or None, default None
        Each random step has a stream of its own, so that adding a mask or a lifetime leaves the scrambling as it is.

    Returns
    -------
    PointLightDisplay

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.display import make_display
    >>> walk = make_walkers(1, random_state=0).data[0]
    >>> make_display(walk, inversion="local", scramble_position=1.0, n_mask_dots=30, random_state=7)
    <PointLightDisplay 'walker_000': 45 dots, 30 of them mask>
    """
    check_choice(inversion, _INVERSIONS, name="inversion")
    _check_pairs((mask_width, mask_height, "mask_width", "mask_height"), (n_visible, lifetime, "n_visible", "lifetime"))
    seeds = (check_random_state(random_state).random_sample(len(_STEPS)) * 2**32).astype(np.int64)
    seed = {step: int(drawn) for step, drawn in zip(_STEPS, seeds, strict=True)}
    names = markers.split() if isinstance(markers, str) else markers
    display = PointLightDisplay.from_walk(walk, n_harmonics=n_harmonics, markers=names)
    display = display.seen_from(view, elevation).with_dots(dot_diameter, polarity).starting_at(start_phase)
    if height is not None or distance is not None:
        display = display.sized(height=height, distance=distance)
    if inversion != "none":
        display = display.inverted(local=inversion == "local")
    display = display.scramble_position(scramble_position, how=scramble_how, random_state=seed["position"])
    display = display.scramble_phase(scramble_phase, random_state=seed["phase"])
    display = display.scramble_period(scramble_period, random_state=seed["period"])
    if translating:
        display = display.translating(speed, start=start_ahead)
    if n_mask_dots:
        area = None if mask_width is None or mask_height is None else (mask_width, mask_height)
        display = display.add_mask(n_mask_dots, area=area, random_state=seed["mask"])
    if n_visible is None or lifetime is None:
        return display
    return display.limit_lifetime(n_visible, lifetime, random_state=seed["lifetime"])


def _check_pairs(*pairs: tuple[object, object, str, str]) -> None:
    """Raise unless both values of each pair are given, or none."""
    for first, second, first_name, second_name in pairs:
        if (first is None) != (second is None):
            raise ValueError(
                f"{first_name} and {second_name} go together, give both or none, got {first_name}={first!r} and "
                f"{second_name}={second!r}"
            )
