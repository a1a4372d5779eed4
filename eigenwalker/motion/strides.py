"""Whole strides: a walk cut from strike to strike, and short walks of one person put together stride by stride."""

from collections.abc import Hashable, Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.interpolate import make_interp_spline

from eigenwalker._collect import collect, report_refusals
from eigenwalker._validation import WalkError, check_finite, check_walks
from eigenwalker.motion.clip import cut
from eigenwalker.motion.fourier import fit_harmonics, reference_phase
from eigenwalker.motion.gait import SIDES, detect_events, heel_strikes, toe_offs
from eigenwalker.motion.phase import phase_weights, stride_frequency
from eigenwalker.motion.symmetry import one_stride_at_least
from eigenwalker.motion.walk import Walk

__all__ = ["cut_to_strides", "pool_walks", "stride_frames"]

_UNEVEN = 1.6  # longest stride over shortest, above which they cannot all be single strides
_LACKING = 1  # frames by which a walk may be shorter than so many strides, besides the one that starts the next
_ROUNDING = 1e-6  # frames or seconds by which a time that lies on a frame may miss it


def cut_to_strides(walk: Walk) -> Walk:
    """Return the part of a walk between the first and the last heel strike of one foot, with its frequency known.

    One stride is enough: a frequency that is counted between two events needs no second one to be compared with. The
    foot whose strikes lie furthest apart is taken; toe offs where neither foot strikes twice. Two events of a foot that
    the walk holds are preferred to any that are detected; those before its first and after its last frame do not count.

    Parameters
    ----------
    walk : Walk
        Leading along x; see `heel_strikes`.

    Returns
    -------
    Walk
        With `frequency` = number of strides / time between first and last event. Its first and last frame are the
        nearest ones outside of these, so that whole strides are in it. Detected events stay in it with those that were
        known: in what is cut the strikes at its ends could not be detected again.

    Raises
    ------
    WalkError
        If no foot strikes or leaves the floor twice, or if one stride is much longer than another, so that an event
        must be missing between its two.
    """
    frames, frequency = stride_frames(walk)
    return replace(cut(detect_events(walk), frames), frequency=frequency)


def stride_frames(walk: Walk) -> tuple[slice, float]:
    """Return the frames that `cut_to_strides` keeps, and the stride frequency in them."""
    times = _event_times(walk)
    strides = np.diff(times)
    if strides.max() > _UNEVEN * strides.min():
        raise WalkError(
            f"walk {walk.name!r}: expected strides of about one length, got {strides.min():.3g} to {strides.max():.3g} "
            "s between the events of one foot; is an event missing, or one too many, or a stop in the walk?"
        )
    first = max(0, int(np.floor(times[0] * walk.frame_rate + _ROUNDING)))
    last = min(walk.n_frames - 1, int(np.ceil(times[-1] * walk.frame_rate - _ROUNDING)))
    return slice(first, last + 1), float(len(strides) / strides.sum())


def _event_times(walk: Walk) -> NDArray[np.float64]:
    """Return when one foot strikes, or leaves the floor: of two feet the one with the longer time between them."""
    end = (walk.n_frames - 1) / walk.frame_rate
    for feet in _candidates(walk):
        inside = [times[(times >= -_ROUNDING) & (times <= end + _ROUNDING)] for times in feet]
        longest = max(inside, key=lambda times: np.ptp(times) if times.size else 0.0)
        if len(longest) > 1:
            return longest
    raise WalkError(
        f"walk {walk.name!r}: expected two heel strikes, or two toe offs, of the same foot, one stride, but no foot "
        f"does either twice in {walk.duration:.3g} s; use a longer recording, or add the events that are known to "
        "walk.events"
    )


def _candidates(walk: Walk) -> Iterator[list[NDArray[np.float64]]]:
    """Yield times of events of the left and the right foot: those in the walk first, heel strikes before toe offs."""
    finders = {"heel_strike": heel_strikes, "toe_off": toe_offs}
    for kind in finders:
        yield [np.array([event.time for event in walk.events if event[1:] == (kind, side)]) for side in SIDES]
    for find in finders.values():
        yield [find(replace(walk, events=()), side) for side in SIDES]


def pool_walks(
    walks: Sequence[Walk],
    groups: Iterable[Hashable],
    *,
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
    on_error : {"raise", "skip"}, default "raise"
        Whether walks that cannot be used raise one error that lists them all, or are left out with one warning that
        lists them; persons of whom no walk is left are then left out too.

    Returns
    -------
    list of Walk
        One a person, in the order in which they first appear, named after the person; with `frequency`, strides over
        time, and mean `speed` over that time known, the speed if it is known of all of the person's walks, and with
        the mean `size` of the strides. Events are left out.

    Raises
    ------
    WalkError
        If a walk has gaps, no period or less than one stride, or if markers differ.
    ValueError
        If `groups` has another length than `walks`, or a walk belongs to no one.

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
    if pd.Series(groups, dtype=object).isna().any():
        raise ValueError("groups must name the person of each walk, got a missing one; leave its walk out")
    names = [walk.name or f"walk {position}" for position, walk in enumerate(walks)]
    found, refusals = collect(_check_stride, walks, names)
    report_refusals(refusals, len(walks), on_error=on_error, what="walks")
    usable = [(walk, one, group) for walk, one, group in zip(walks, found, groups, strict=True) if one is not None]
    return [
        _pool([(walk, frequency) for walk, frequency, group in usable if group == person], str(person))
        for person in dict.fromkeys(group for *_, group in usable)
    ]


def _check_stride(walk: Walk) -> float:
    """Return the stride frequency of a walk without gaps that has a whole stride."""
    check_finite(walk.channels, walk.channel_names, walk=walk.name)
    return stride_frequency(walk)


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
    times = n_strides / frequencies
    frequency = float(n_strides.sum() / times.sum())
    return first.with_channels(
        np.concatenate(parts),
        frame_rate=n_samples * frequency,
        name=name,
        speed=float(np.average(speeds, weights=times)),
        size=float(np.average(sizes, weights=n_strides)),
        events=(),
        frequency=frequency,
    )


def _whole_strides(walk: Walk, frequency: float, n_samples: int) -> NDArray[np.float64]:
    """Return whole strides of a walk, each from phase zero on, shape (n_strides n_samples, n_channels).

    The strides start where the walk starts; within each, frames before phase zero move behind the others. Where the
    last stride lacks its last frames they are those of the stride before, or of the other end of a single one.
    """
    channels: NDArray[np.floating] = np.asarray(walk.channels, dtype=np.float64)
    n_harmonics = 2 if 2 * frequency < 0.5 * walk.frame_rate else 1
    coefficients = fit_harmonics(channels, walk.frame_rate, frequency, n_harmonics)
    start = -reference_phase(coefficients, phase_weights(walk)) / (2 * np.pi)  # strides, in the first frame
    stride = walk.frame_rate / frequency  # frames
    n_strides = max(1, int((walk.n_frames + _LACKING) / stride + _ROUNDING))
    places = int(np.ceil(start * n_samples)) + np.arange(n_strides * n_samples)
    frames = (places / n_samples - start) * stride
    times, channels = one_stride_at_least(np.arange(walk.n_frames, dtype=np.float64), channels, stride)
    frames = np.where(frames > times[-1], frames - stride, frames)
    sampled = make_interp_spline(times, channels, k=5)(np.clip(frames, times[0], times[-1]))
    ordered = np.empty_like(sampled)
    within = np.arange(len(places))
    ordered[within // n_samples * n_samples + places % n_samples] = sampled
    return ordered
