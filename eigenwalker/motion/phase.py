"""The signal that tells where in its stride a walk is, and the stride frequency."""

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from eigenwalker._validation import WalkError
from eigenwalker.motion.fourier import FREQUENCY_RANGE, coarse_frequency, estimate_frequency
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = ["find_stride", "phase_weights", "stride_frequency"]

_DUST = 1e-9  # relative size of rounding, in which a sine may be found as well


def phase_weights(walk: Walk | JointWalk, phase_reference: str | Mapping[str, float] = "auto") -> NDArray[np.float64]:
    """Return the weight of each channel in the phase reference, shape (n_channels,).

    Parameters
    ----------
    walk : Walk or JointWalk
        Whose channels are weighted.
    phase_reference : "auto" or mapping of str to float, default "auto"
        Channels with weights. "auto" is left minus right ankle, forward, for markers, and left minus right hip
        flexion for joints of an upright skeleton.

    Raises
    ------
    WalkError
        If the walk lacks one of the channels.
    ValueError
        If `phase_reference` is another string or names no channel.
    """
    if isinstance(phase_reference, str) and phase_reference != "auto":
        raise ValueError(f"phase_reference must be 'auto' or a mapping of channels to weights, got {phase_reference!r}")
    wanted = walk.phase_channels if isinstance(phase_reference, str) else phase_reference
    if not wanted or not any(wanted.values()):
        raise ValueError("phase_reference must name at least one channel with a weight other than zero, got none")
    names = walk.channel_names
    missing = [name for name in wanted if name not in names]
    if missing:
        raise WalkError(
            f"walk {walk.name!r}: no channel {', '.join(missing)} for the phase reference; pass "
            f"phase_reference={{channel: weight}} with channels out of {', '.join(names)}"
        )
    weights = np.zeros(len(names))
    for name, weight in wanted.items():
        weights[names.index(name)] = weight
    return weights


def stride_frequency(
    walk: Walk | JointWalk,
    *,
    phase_reference: str | Mapping[str, float] = "auto",
    frequency_range: tuple[float, float] = FREQUENCY_RANGE,
) -> float:
    """Return the stride frequency of a walk in place: the fundamental of all its channels, in hertz.

    It is the walk's own `frequency` where that is known. Else the first guess comes from the phase reference, in which
    left and right differ, so that it is the stride's and not the step's; variable projection on all channels makes it
    exact.

    Parameters
    ----------
    walk : Walk or JointWalk
        Prepared: without its path over the floor.
    phase_reference : "auto" or mapping of str to float, default "auto"
        See `phase_weights`.
    frequency_range : tuple of float, default (0.3, 2.5)
        In hertz.

    Raises
    ------
    WalkError
        If the walk has no period in the range, or less than one stride.
    """
    weights = phase_weights(walk, phase_reference)
    return find_stride(
        walk.channels,
        walk.frame_rate,
        weights,
        known=walk.frequency,
        frequency_range=frequency_range,
        name=walk.name,
    )


def find_stride(
    channels: NDArray[np.floating],
    frame_rate: float,
    weights: NDArray[np.floating],
    *,
    known: float = math.nan,
    frequency_range: tuple[float, float] = FREQUENCY_RANGE,
    name: str = "",
) -> float:
    """Return the stride frequency in hertz, from channels (n_frames, n_channels) and the weights of `phase_weights`.

    Where it is `known` already it is only checked that there is a stride and a phase.
    """
    used = weights.nonzero()[0]
    picked = channels[:, used]
    reference = picked @ weights[used]
    if reference.max() - reference.min() <= _DUST * np.abs(weights[used]) @ np.abs(picked).max(axis=0):
        raise WalkError(
            f"walk {name!r}: the phase reference is too weak to carry a phase, it does not move at all; "
            "are left and right markers different, or is another phase_reference needed?"
        )
    frequency = known
    if math.isnan(known):
        start = coarse_frequency(reference, frame_rate, frequency_range=frequency_range, name=name)
        frequency = estimate_frequency(channels, frame_rate, start=start)
    n_strides = frequency * len(channels) / frame_rate
    if n_strides < 1 - 2 / len(channels):  # a stride cut from strike to strike may lack a frame
        raise WalkError(
            f"walk {name!r}: expected at least one stride, got {n_strides:.2f}, {len(channels)} frames at "
            f"{frame_rate:g} frames and {frequency:.3g} strides a second; use a longer recording"
        )
    return frequency
