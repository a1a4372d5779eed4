"""The amplitude spectra of walks' channels, with the stride frequency marked."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple, Self

import numpy as np
import pandas as pd

from eigenwalker._validation import check_walks
from eigenwalker.display._canvas import figure_of, take_grid, to_png
from eigenwalker.motion.gait import step_frequency
from eigenwalker.motion.phase import stride_frequency
from eigenwalker.motion.spectrum import spectrum
from eigenwalker.motion.walk import JointWalk, Walk

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["SpectrumDisplay", "WalkSpectrum"]

_ONE = (6.4, 3.4)  # width and height of a panel, in inches, alone
_MANY = (2.5, 1.7)  # and among others
_N_COLUMNS = 3


class WalkSpectrum(NamedTuple):
    """What one panel of a `SpectrumDisplay` shows.

    Parameters
    ----------
    amplitudes : DataFrame
        From `spectrum`, without the mean posture at 0 Hz.
    frequency : float
        Stride frequency in hertz.
    name : str
        Above the panel.
    unit : str
        Of the channels.
    step_frequency : float, default NaN
        Stride frequency that the steps have, in hertz; NaN where it is not drawn.
    """

    amplitudes: pd.DataFrame
    frequency: float
    name: str
    unit: str
    step_frequency: float = float("nan")


class SpectrumDisplay:
    """Amplitude spectra of all channels, and their root mean square (Tilmanne & Dutoit 2012, Fig. 1 and 2).

    Parameters
    ----------
    spectra : list of WalkSpectrum
        One a panel.
    same_scale : bool, default True
        Whether amplitudes have the same scale in all panels.

    Attributes
    ----------
    axes_ : list of matplotlib Axes
        What was drawn on, one a walk.
    ax_ : matplotlib Axes
        The first of them.
    figure_ : matplotlib Figure
        The figure they belong to.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.display import SpectrumDisplay
    >>> walks = make_walkers(3, random_state=0).data
    >>> SpectrumDisplay.from_walk(walks[0]).ax_.get_xlabel()
    'frequency (Hz)'
    >>> len(SpectrumDisplay.from_walks(walks, labels=["anna", "bert", "cleo"]).axes_)
    3
    """

    def __init__(self, spectra: Sequence[WalkSpectrum], *, same_scale: bool = True) -> None:
        self.spectra = spectra
        self.same_scale = same_scale

    @classmethod
    def from_walk(
        cls, walk: Walk | JointWalk, *, n_harmonics: int = 5, steps: bool = False, ax: Axes | None = None
    ) -> Self:
        """Draw the spectra of a walk.

        Parameters
        ----------
        walk : Walk or JointWalk
            Prepared.
        n_harmonics : int, default 5
            Up to which multiple of the stride frequency; half a one is drawn beyond.
        steps : bool, default False
            Whether a triangle marks the frequency that the steps have, `step_frequency`.
        ax : matplotlib Axes, default None
            Where to draw. None makes a new figure.

        Returns
        -------
        SpectrumDisplay

        Raises
        ------
        WalkError
            If the walk has gaps, no period or less than one stride.
        ValueError
            If `n_harmonics` is below 1.
        """
        return cls.from_walks([walk], n_harmonics=n_harmonics, steps=steps, ax=ax)

    @classmethod
    def from_walks(
        cls,
        walks: Sequence[Walk | JointWalk],
        *,
        labels: Sequence[str] | None = None,
        n_harmonics: int = 5,
        steps: bool = False,
        same_scale: bool = True,
        ax: Axes | Sequence[Axes] | None = None,
    ) -> Self:
        """Draw the spectra of several walks, one panel a walk: one walk of each style, for instance.

        Parameters
        ----------
        walks : list of Walk or JointWalk
            Prepared; all of one kind.
        labels : sequence of str, default None
            What stands above the panels. None is the names of the walks.
        n_harmonics : int, default 5
            Up to which multiple of the highest stride frequency; half a one is drawn beyond.
        steps : bool, default False
            Whether triangles mark the frequencies that the steps have, `step_frequency`.
        same_scale : bool, default True
            Whether amplitudes have the same scale in all panels, to compare walks; else each panel has its own.
        ax : matplotlib Axes or sequence of Axes, default None
            Where to draw, one a walk. None makes a new figure with three panels in a row.

        Returns
        -------
        SpectrumDisplay

        Raises
        ------
        WalkError
            If a walk has gaps, no period or less than one stride.
        ValueError
            If `n_harmonics` is below 1, if markers and joints are mixed, or if there is another number of labels.
        """
        walks = check_walks(walks, kind=(Walk, JointWalk))
        if n_harmonics < 1:
            raise ValueError(f"n_harmonics must be at least 1, got {n_harmonics!r}")
        if len({type(walk) for walk in walks}) > 1:
            raise ValueError("walks must be all of markers or all of joints, whose units differ, got both")
        labels = [walk.name for walk in walks] if labels is None else list(labels)
        if len(labels) != len(walks):
            raise ValueError(f"labels must be {len(walks)} names, one a walk, got {len(labels)}")
        frequencies = [stride_frequency(walk) for walk in walks]
        highest = (n_harmonics + 0.5) * max(frequencies)
        spectra = [
            WalkSpectrum(
                amplitudes=spectrum(walk, max_frequency=highest).iloc[1:],
                frequency=frequency,
                name=label,
                unit="m" if isinstance(walk, Walk) else "rad",
                step_frequency=step_frequency(walk) if steps else float("nan"),
            )
            for walk, frequency, label in zip(walks, frequencies, labels, strict=True)
        ]
        return cls(spectra, same_scale=same_scale).plot(ax=ax)

    def plot(self, ax: Axes | Sequence[Axes] | None = None) -> Self:
        """Draw on the given axes, or on new ones.

        Parameters
        ----------
        ax : matplotlib Axes or sequence of Axes, default None
            Where to draw, one a walk.

        Returns
        -------
        self
        """
        alone = len(self.spectra) == 1
        self.axes_ = take_grid(ax, len(self.spectra), _N_COLUMNS, _ONE if alone else _MANY)
        self.ax_, self.figure_ = self.axes_[0], figure_of(self.axes_[0])
        for panel, shown in zip(self.axes_, self.spectra, strict=True):
            _draw(panel, shown, alone=alone)
        _set_scales(self.axes_, max(shown.amplitudes.index[-1] for shown in self.spectra), same=self.same_scale)
        frequency, amplitude = "frequency (Hz)", f"amplitude ({self.spectra[0].unit})"
        if alone or ax is not None:
            for panel in self.axes_:
                panel.set(xlabel=frequency, ylabel=amplitude)
            self.ax_.legend(frameon=False, fontsize="small", loc="upper right")
        else:
            self.figure_.supxlabel(frequency, fontsize="medium")
            self.figure_.supylabel(amplitude, fontsize="medium")
            handles, names = self.ax_.get_legend_handles_labels()
            self.figure_.legend(handles, names, frameon=False, fontsize="small", loc="outside upper center", ncols=4)
        return self

    def _repr_png_(self) -> bytes:
        """Show the figure in a notebook."""
        return to_png(self.figure_)


def _draw(ax: Axes, shown: WalkSpectrum, *, alone: bool) -> None:
    """Draw the spectra of one walk."""
    frequencies = shown.amplitudes.index.to_numpy()
    lines = ax.plot(frequencies, shown.amplitudes.to_numpy(), color="0.72", lw=0.6)
    lines[0].set_label("channels")
    spread = np.sqrt((shown.amplitudes**2).mean(axis=1))
    ax.plot(frequencies, spread, color="black", lw=1.8 if alone else 1.2, label="their root mean square")
    number = f", {shown.frequency:.2f} Hz," if alone else ""
    for multiple in range(1, int(frequencies[-1] / shown.frequency) + 1):
        label = f"stride frequency{number} and its multiples" if multiple == 1 else None
        ax.axvline(multiple * shown.frequency, color="black", lw=0.8, ls=":", zorder=0, label=label)
    if not np.isnan(shown.step_frequency):
        label = f"that of the steps{f', {shown.step_frequency:.2f} Hz' if alone else ''}"
        ax.plot(shown.step_frequency, 0.0, "k^", ms=6 if alone else 4, ls="", clip_on=False, zorder=6, label=label)
    title = shown.name if alone else f"{shown.name}, {shown.frequency:.2f} Hz"
    ax.set_title(title, loc="left", fontsize="medium")
    ax.spines[["top", "right"]].set_visible(False)


def _set_scales(axes: Sequence[Axes], highest: float, *, same: bool) -> None:
    """Show frequencies from zero to the highest one, and amplitudes from zero, all to the same height or not."""
    tops = [ax.get_ylim()[1] for ax in axes]
    for ax, top in zip(axes, tops, strict=True):
        ax.set(xlim=(0, highest), ylim=(0, max(tops) if same else top))
