"""The amplitude spectra of a walk's channels, with the stride frequency marked."""

from __future__ import annotations

from typing import TYPE_CHECKING, Self

import numpy as np
import pandas as pd

from eigenwalker.display._canvas import figure_of, take_axes, to_png
from eigenwalker.motion.phase import stride_frequency
from eigenwalker.motion.spectrum import spectrum
from eigenwalker.motion.walk import JointWalk, Walk

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["SpectrumDisplay"]


class SpectrumDisplay:
    """Amplitude spectra of all channels, and their root mean square (Tilmanne & Dutoit 2012, Fig. 1 and 2).

    Parameters
    ----------
    amplitudes : DataFrame
        From `spectrum`, without the mean posture at 0 Hz.
    frequency : float
        Stride frequency in hertz.
    name : str
        Of the walk.
    unit : str
        Of the channels.

    Attributes
    ----------
    ax_ : matplotlib Axes
        What was drawn on.
    figure_ : matplotlib Figure
        The figure it belongs to.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.display import SpectrumDisplay
    >>> SpectrumDisplay.from_walk(make_walkers(1, random_state=0).data[0]).ax_.get_xlabel()
    'frequency (Hz)'
    """

    def __init__(self, amplitudes: pd.DataFrame, frequency: float, *, name: str, unit: str) -> None:
        self.amplitudes = amplitudes
        self.frequency = frequency
        self.name = name
        self.unit = unit

    @classmethod
    def from_walk(cls, walk: Walk | JointWalk, *, n_harmonics: int = 5, ax: Axes | None = None) -> Self:
        """Draw the spectra of a walk.

        Parameters
        ----------
        walk : Walk or JointWalk
            Prepared.
        n_harmonics : int, default 5
            Up to which multiple of the stride frequency; half a one is drawn beyond.
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
        if n_harmonics < 1:
            raise ValueError(f"n_harmonics must be at least 1, got {n_harmonics!r}")
        frequency = stride_frequency(walk)
        amplitudes = spectrum(walk, max_frequency=(n_harmonics + 0.5) * frequency).iloc[1:]
        return cls(amplitudes, frequency, name=walk.name, unit="m" if isinstance(walk, Walk) else "rad").plot(ax=ax)

    def plot(self, ax: Axes | None = None) -> Self:
        """Draw on the given axes, or on new ones.

        Parameters
        ----------
        ax : matplotlib Axes, default None
            Where to draw.

        Returns
        -------
        self
        """
        (ax,) = take_axes(ax, (6.4, 3.4))
        self.ax_, self.figure_ = ax, figure_of(ax)
        frequencies = self.amplitudes.index.to_numpy()
        lines = ax.plot(frequencies, self.amplitudes.to_numpy(), color="0.72", lw=0.6)
        lines[0].set_label("channels")
        spread = np.sqrt((self.amplitudes**2).mean(axis=1))
        ax.plot(frequencies, spread, color="black", lw=1.8, label="their root mean square")
        for multiple in range(1, int(frequencies[-1] / self.frequency) + 1):
            label = f"stride frequency, {self.frequency:.2f} Hz, and its multiples" if multiple == 1 else None
            ax.axvline(multiple * self.frequency, color="black", lw=0.8, ls=":", zorder=0, label=label)
        ax.set(xlabel="frequency (Hz)", ylabel=f"amplitude ({self.unit})", xlim=(0, frequencies[-1]), ylim=(0, None))
        ax.set_title(self.name, loc="left", fontsize="medium")
        ax.spines[["top", "right"]].set_visible(False)
        ax.legend(frameon=False, fontsize="small", loc="upper right")
        return self

    def _repr_png_(self) -> bytes:
        """Show the figure in a notebook."""
        return to_png(self.figure_)
