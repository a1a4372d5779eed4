"""A joint or a marker taken apart into its mean and its harmonics, and put together again."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Self

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from eigenwalker._validation import WalkError, check_finite
from eigenwalker.display._canvas import figure_of, take_grid, to_png
from eigenwalker.motion.fourier import amplitude_phase, evaluate_harmonics, explained_by, fit_harmonics
from eigenwalker.motion.phase import stride_frequency
from eigenwalker.motion.rigs import find_rig
from eigenwalker.motion.walk import JointWalk, Walk

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["DecompositionDisplay"]

_PANEL = (6.4, 1.15)  # inches
_AXES = ("x", "y", "z")
_STYLES: tuple[dict[str, Any], ...] = (
    {"ls": "-", "lw": 1.2},
    {"ls": (0, (5, 1.5)), "lw": 1.2},
    {"ls": (0, (1, 1)), "lw": 1.4},
)
_MARGIN = 0.08  # of the span, above and below what is drawn


class DecompositionDisplay:
    """The three channels of a joint or marker, their mean, each harmonic, and the sum (Tilmanne & Dutoit 2012, Fig. 3).

    Panels from top to bottom: the original, its mean, the harmonics, and the sum of all of these with the original
    behind it in gray. Harmonic 1 is the fundamental, and harmonic 2 what the source calls the first harmonic. All
    panels span the same, so that sizes can be compared by eye.

    Parameters
    ----------
    channels : DataFrame
        The original, one row a frame with the time in seconds as index, three columns.
    coefficients : ndarray of shape (2 K + 1, 3)
        Rows mean, sin1, cos1, ...
    frequency : float
        Stride frequency in hertz.
    name : str
        Above the first panel.
    unit : str
        Of the channels.

    Attributes
    ----------
    axes_ : list of matplotlib Axes
        What was drawn on, from top to bottom.
    figure_ : matplotlib Figure
        The figure they belong to.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.display import DecompositionDisplay
    >>> display = DecompositionDisplay.from_walk(make_walkers(1, random_state=0).data[0], "left_ankle")
    >>> len(display.axes_)
    5
    >>> display.table().columns.to_list()
    ['amplitude', 'phase']
    """

    def __init__(
        self, channels: pd.DataFrame, coefficients: NDArray[np.floating], frequency: float, *, name: str, unit: str
    ) -> None:
        self.channels = channels
        self.coefficients = coefficients
        self.frequency = frequency
        self.name = name
        self.unit = unit

    @classmethod
    def from_walk(
        cls,
        walk: Walk | JointWalk,
        part: str,
        *,
        n_harmonics: int = 2,
        fit: Callable[..., NDArray[np.float64]] = fit_harmonics,
        ax: Sequence[Axes] | None = None,
    ) -> Self:
        """Draw one joint or marker of a walk.

        Parameters
        ----------
        walk : Walk or JointWalk
            Prepared, in place.
        part : str
            A marker; or a joint that has channels, by its own name or that of the marker which the rig puts there:
            "left_knee" is the joint of the left knee in all skeletons that are known.
        n_harmonics : int, default 2
            Number of harmonics, the fundamental included.
        fit : callable, default fit_harmonics
            Takes channels, frame rate, frequency and number of harmonics and returns coefficients; the source's is
            `project_harmonics`.
        ax : sequence of matplotlib Axes, default None
            Where to draw, `n_harmonics` + 3. None makes a new figure.

        Returns
        -------
        DecompositionDisplay

        Raises
        ------
        WalkError
            If the walk has gaps, no period, less than one stride, or no such joint or marker.
        """
        names = _channels_of(walk, part)
        places = [walk.channel_names.index(name) for name in names]
        check_finite(walk.channels, walk.channel_names, walk=walk.name)
        picked = np.asarray(walk.channels[:, places], dtype=np.float64)
        frequency = stride_frequency(walk)
        times = pd.Index(np.arange(walk.n_frames) / walk.frame_rate, name="time")
        return cls(
            pd.DataFrame(picked, index=times, columns=names),
            fit(picked, walk.frame_rate, frequency, n_harmonics),
            frequency,
            name=", ".join(text for text in (walk.name, part.replace("_", " ")) if text),
            unit="m" if isinstance(walk, Walk) else "rad",
        ).plot(ax=ax)

    def table(self) -> pd.DataFrame:
        """Return amplitude and phase of each harmonic of each channel: amplitude cos(k omega t + phase).

        Returns
        -------
        DataFrame
            Index: channel and harmonic, 0 for the mean, which has no phase. Columns: amplitude, in the unit of the
            channels, and phase, in radians, at the first frame.
        """
        amplitude, phase = amplitude_phase(self.coefficients)
        rows = {
            "amplitude": np.vstack((self.coefficients[:1], amplitude)).T.ravel(),
            "phase": np.vstack((np.full((1, phase.shape[1]), np.nan), phase)).T.ravel(),
        }
        harmonics = range(len(amplitude) + 1)
        index = pd.MultiIndex.from_product([self.channels.columns, harmonics], names=["channel", "harmonic"])
        return pd.DataFrame(rows, index=index)

    def parts(self) -> dict[str, NDArray[np.float64]]:
        """Return what the panels show, each of shape (n_frames, 3), by their names."""
        times, original = self.channels.index.to_numpy(), self.channels.to_numpy()
        shown = {"original": original, "mean": np.tile(self.coefficients[0], (len(times), 1))}
        for number in range(1, (len(self.coefficients) - 1) // 2 + 1):
            alone = np.zeros_like(self.coefficients)
            rows = slice(2 * number - 1, 2 * number + 1)
            alone[rows] = self.coefficients[rows]
            name = f"harmonic {number}\n{number * self.frequency:.2f} Hz"
            shown[name] = evaluate_harmonics(alone, self.frequency, times)
        frame_rate = 1 / (times[1] - times[0])
        explained = explained_by(self.coefficients, original, frame_rate, self.frequency)
        total = f"sum, explains\n{100 * explained:.1f} % of\noriginal (gray)"
        shown[total] = evaluate_harmonics(self.coefficients, self.frequency, times)
        return shown

    def plot(self, ax: Sequence[Axes] | None = None) -> Self:
        """Draw on the given axes, or on new ones.

        Parameters
        ----------
        ax : sequence of matplotlib Axes, default None
            Where to draw, one a panel.

        Returns
        -------
        self
        """
        parts = self.parts()
        times, original = self.channels.index.to_numpy(), parts["original"]
        self.axes_ = take_grid(ax, len(parts), 1, _PANEL)
        self.figure_ = figure_of(self.axes_[0])
        span = max(float(np.ptp(values)) for values in parts.values()) * (1 + 2 * _MARGIN) or 1.0
        for number, (panel, (name, values)) in enumerate(zip(self.axes_, parts.items(), strict=True)):
            last = number == len(parts) - 1
            if last:
                panel.plot(times, original, color="0.7", lw=2.4)
            for axis, path, style in zip(_AXES, values.T, _STYLES, strict=True):
                panel.plot(times, path, color="black", label=axis, **style)
            _set_panel(panel, name, original if last else values, span, last=last)
        self.axes_[0].set_title(self.name, loc="left", fontsize="medium")
        self.axes_[0].legend(frameon=False, fontsize="small", ncols=3, loc="lower right", bbox_to_anchor=(1.0, 1.0))
        quantity = f"{'exponential map' if self.unit == 'rad' else 'position'} ({self.unit})"
        if ax is None:
            self.figure_.supylabel(quantity, fontsize="medium")
        else:
            self.axes_[len(parts) // 2].set_ylabel(quantity)
        return self

    def _repr_png_(self) -> bytes:
        """Show the figure in a notebook."""
        return to_png(self.figure_)


def _set_panel(ax: Axes, name: str, values: NDArray[np.float64], span: float, *, last: bool) -> None:
    """Write the name of a panel, and show the values in the middle of a span."""
    middle = (values.min() + values.max()) / 2
    ax.set(ylim=(middle - span / 2, middle + span / 2))
    ax.margins(x=0)
    ax.text(1.015, 0.5, name, transform=ax.transAxes, ha="left", va="center", fontsize="small")
    ax.spines[["top", "right"]].set_visible(False)
    if last:
        ax.set_xlabel("time (s)")
    else:
        ax.tick_params(labelbottom=False)


def _channels_of(walk: Walk | JointWalk, part: str) -> list[str]:
    """Return the names of the three channels of a marker or joint."""
    known = [name.removesuffix("_x") for name in walk.channel_names[::3]]
    found = part
    if part not in known and isinstance(walk, JointWalk):
        place = find_rig(walk.skeleton.joint_names).markers.get(part)
        found = place if isinstance(place, str) else part
    if found not in known:
        raise WalkError(f"walk {walk.name!r}: no marker or joint {part!r} with channels; it has {', '.join(known)}")
    return [f"{found}_{axis}" for axis in _AXES]
