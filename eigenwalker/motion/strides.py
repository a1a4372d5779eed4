"""Whole strides: a walk cut from strike to strike, and short walks of one person put together stride by stride."""

from collections.abc import Hashable, Iterable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import make_interp_spline

from eigenwalker._collect import collect, report_refusals
from eigenwalker._validation import WalkError, check_finite, check_walks
from eigenwalker.motion.fourier import FREQUENCY_RANGE, fit_harmonics, reference_phase
from eigenwalker.motion.gait import SIDES, heel_strikes
from eigenwalker.motion.passes import cut
from eigenwalker.motion.phase import phase_weights, stride_frequency
from eigenwalker.motion.walk import Walk

__all__ = ["cut_to_strides", "pool_walks"]


def cut_to_strides(walk: Walk) -> Walk:
    """Return the part of a walk between the first and the last heel strike of one foot, with its frequency known.

    One stride is enough: a frequency that is counted between two events needs no second one to be compared with. The
    foot whose strikes lie furthest apart is taken. Events in the walk are preferred to detected ones.

    Parameters
    ----------
    walk : Walk
        Leading along x; see `heel_strikes`.

    Returns
    -------
    Walk
        With `frequency` = number of strides / time between the strikes. Its first and last frame are the nearest ones
        outside of the strikes, so that whole strides are in it.

    Raises
    ------
    WalkError
        If no foot strikes twice.
    """
    strikes = {side: heel_strikes(walk, side) for side in SIDES}
    side = max(SIDES, key=lambda side: np.ptp(strikes[side]) if len(strikes[side]) > 1 else -1.0)
    times = strikes[side]
    if len(times) < 2:
        found = ", ".join(f"{len(strikes[side])} of the {side} foot" for side in SIDES)
        raise WalkError(
            f"walk {walk.name!r}: expected two heel strikes of the same foot, one stride, got {found} in "
            f"{walk.duration:.3g} s; use a longer recording, or add the events that are known to walk.events"
        )
    first = max(0, int(np.floor(times[0] * walk.frame_rate)))
    last = min(walk.n_frames - 1, int(np.ceil(times[-1] * walk.frame_rate)))
    return replace(cut(walk, slice(first, last + 1)), frequency=float((len(times) - 1) / (times[-1] - times[0])))


def pool_walks(
    walks: Sequence[Walk],
    groups: Iterable[Hashable],
    *,
    frequency_range: tuple[float, float] = FREQUENCY_RANGE,
    on_error: str = "raise",
) -> list[Walk]:
    """Return one walk a person: the whole strides of all that person's walks, one after the other.

    Each walk is brought to the person's mean frequency and to one phase, left minus right ankle furthest forward at
    the start of a stride, and cut to whole strides. The Fourier model of the result is the model of all strides
    together, each counted once; what differs from walk to walk is part of its residual. Short passes that hardly
    carry a model of their own are fitted that way.

    Parameters
    ----------
    walks : list of Walk
        Prepared, with one marker set.
    groups : iterable
        Which person each walk is of, in the same order.
    frequency_range : tuple of float, default (0.3, 2.5)
        Where the stride frequency of walks that do not know theirs is looked for, in hertz.
    on_error : {"raise", "skip"}, default "raise"
        Whether walks that cannot be used raise one error that lists them all, or are left out with one warning that
        lists them; persons of whom no walk is left are then left out too.

    Returns
    -------
    list of Walk
        One a person, in the order in which they first appear, named after the person; with the mean `speed` and
        `size` of the strides and with `frequency` known. Events are left out.

    Raises
    ------
    WalkError
        If a walk has gaps, no period or less than one stride, or if markers differ.
    ValueError
        If `groups` has another length than `walks`.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.motion import pool_walks
    >>> walks = make_walkers(4, random_state=0).data
    >>> [walk.name for walk in pool_walks(walks, ["anna", "bert", "anna", "bert"])]
    ['anna', 'bert']
    """
    walks = check_walks(walks, kind=Walk)
    groups = list(groups)
    if len(groups) != len(walks):
        raise ValueError(f"expected one group a walk, {len(walks)}, got {len(groups)}")
    differing = [walk.name for walk in walks if walk.marker_set.names != walks[0].marker_set.names]
    if differing:
        raise WalkError(
            f"walk {differing[0]!r}: expected the markers of the first walk; bring all walks to one marker set first"
        )
    names = [walk.name or f"walk {position}" for position, walk in enumerate(walks)]
    found, refusals = collect(partial(_check_stride, frequency_range=frequency_range), walks, names)
    report_refusals(refusals, len(walks), on_error=on_error, what="walks")
    usable = [(walk, one, group) for walk, one, group in zip(walks, found, groups, strict=True) if one is not None]
    return [
        _pool([(walk, frequency) for walk, frequency, group in usable if group == person], str(person))
        for person in dict.fromkeys(group for *_, group in usable)
    ]


def _check_stride(walk: Walk, *, frequency_range: tuple[float, float]) -> float:
    """Return the stride frequency of a walk without gaps that has a whole stride."""
    check_finite(walk.channels, walk.channel_names, walk=walk.name)
    return stride_frequency(walk, frequency_range=frequency_range)


def _pool(walks: Sequence[tuple[Walk, float]], name: str) -> Walk:
    """Return one walk out of walks with their frequencies."""
    first, _ = walks[0]
    frequencies = np.array([frequency for _, frequency in walks])
    rates, durations, speeds, sizes = np.array(
        [(walk.frame_rate, walk.duration, walk.speed, walk.size) for walk, _ in walks]
    ).T
    n_samples = round(rates.mean() / np.average(frequencies, weights=durations))  # frames of a stride, in all walks
    parts = [_whole_strides(walk, frequency, n_samples) for walk, frequency in walks]
    n_strides = np.array([len(part) / n_samples for part in parts])
    frequency = float(n_strides.sum() / (n_strides / frequencies).sum())
    return first.with_channels(
        np.concatenate(parts),
        frame_rate=n_samples * frequency,
        name=name,
        speed=float(np.average(speeds, weights=n_strides)),
        size=float(np.average(sizes, weights=n_strides)),
        events=(),
        frequency=frequency,
    )


def _whole_strides(walk: Walk, frequency: float, n_samples: int) -> NDArray[np.float64]:
    """Return whole strides of a walk, each from phase zero on, shape (n_strides n_samples, n_channels).

    The strides start where the walk starts; within each, frames before phase zero move behind the others.
    """
    channels = np.asarray(walk.channels, dtype=np.float64)
    n_harmonics = 2 if 2 * frequency < 0.5 * walk.frame_rate else 1
    coefficients = fit_harmonics(channels, walk.frame_rate, frequency, n_harmonics)
    start = -reference_phase(coefficients, phase_weights(walk)) / (2 * np.pi)  # strides, in the first frame
    end = start + (walk.n_frames - 1) * frequency / walk.frame_rate
    first, last = int(np.ceil(start * n_samples)), int(np.floor(end * n_samples))
    n_strides = (last - first + 1) // n_samples
    if n_strides < 1:
        raise WalkError(
            f"walk {walk.name!r}: expected at least one whole stride, got {end - start:.2f}; use a longer one"
        )
    places = first + np.arange(n_strides * n_samples)
    frames = (places / n_samples - start) * walk.frame_rate / frequency
    sampled = make_interp_spline(np.arange(walk.n_frames), channels, k=5)(np.clip(frames, 0, walk.n_frames - 1))
    ordered = np.empty_like(sampled)
    within = np.arange(len(places))
    ordered[within // n_samples * n_samples + places % n_samples] = sampled
    return ordered
