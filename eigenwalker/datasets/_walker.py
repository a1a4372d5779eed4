"""One walker: a body, the curves of its joints, and the closed stride they make."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eigenwalker.datasets._anatomy import BODY_PARAMETERS, JOINTS, body_skeleton
from eigenwalker.datasets._gait_curves import (
    AXIAL_CURVES,
    HEEL_LIFT,
    LIMB_CURVES,
    N_HARMONICS,
    NORMATIVE,
    curve_values,
    shift_curve,
    stride_waves,
)
from eigenwalker.datasets._kinematics import Posture, posture, stance_height, stance_velocity, support
from eigenwalker.datasets._parameters import PARAMETERS
from eigenwalker.motion import TROJE15, Skeleton, fit_harmonics, reference_phase, shift_phase

__all__ = ["FEATURES", "Walker", "make_walker", "stride_features", "walker_markers"]

_CYCLE = np.arange(128) / 128  # phases of the closed stride
_CYCLE_WAVES = stride_waves(_CYCLE)
_N_LEG_CURVES = sum(name.startswith(("hip", "knee", "foot")) for name in LIMB_CURVES)
_STEADINESS = 0.65  # share of the pelvis's surging that the hips take up
_WAVES = ("sin1", "cos1", "sin2", "cos2", "sin3", "cos3")

FEATURES = (
    *(f"{row}_{marker}_{axis}" for row in ("mean", "sin1", "cos1", "sin2", "cos2") for marker in TROJE15.names
      for axis in "xyz"),
    "frequency",
)  # fmt: skip


class Walker(NamedTuple):
    """What `make_walker` returns.

    Parameters
    ----------
    skeleton : Skeleton
        The body.
    axial : ndarray of shape (n_axial_curves, 2 K + 1)
        Coefficients of the angles of pelvis, trunk and neck.
    left, right : ndarray of shape (n_limb_curves, 2 K + 1)
        Coefficients of the angles of the limbs, each from the heel strike of its own side.
    sway : ndarray of shape (2, 2 K + 1)
        Coefficients of the pelvis's x and y about its steady way forward, in metres.
    stride_length : float
        In metres.
    frequency : float
        Strides per second.
    """

    skeleton: Skeleton
    axial: NDArray[np.float64]
    left: NDArray[np.float64]
    right: NDArray[np.float64]
    sway: NDArray[np.float64]
    stride_length: float
    frequency: float


def make_walker(parameters: NDArray[np.float64]) -> Walker:
    """Return the walker of a parameter vector, shape (n_parameters,) in the order of `PARAMETERS`."""
    named = dict(zip(PARAMETERS, parameters.tolist(), strict=True))
    skeleton = body_skeleton({name: named[name] for name in BODY_PARAMETERS})
    axial = np.array([_curve(named, name, side=0.0) for name in AXIAL_CURVES])
    left, right = (np.array([_curve(named, name, side=side) for name in LIMB_CURVES]) for side in (0.5, -0.5))
    loose = Walker(skeleton, axial, left, right, np.zeros((2, 2 * N_HARMONICS + 1)), 0.0, named["frequency"])
    return _on_the_ground(_steadied(_on_the_ground(loose)))


def _on_the_ground(walker: Walker) -> Walker:
    """Move the pelvis so that the standing foot stays where it is."""
    velocity = stance_velocity(_posture(walker, _CYCLE_WAVES, _CYCLE_WAVES).soles, support(_CYCLE))
    return walker._replace(sway=_integrate(velocity), stride_length=float(velocity[:, 0].mean()))


def _steadied(walker: Walker) -> Walker:
    """Swing the thighs so that the feet stay where they are while the pelvis surges less.

    Stiff curves would shake the pelvis back and forth by their individual deviations, which nobody does.
    """
    legs = -np.sum(walker.skeleton.offsets[[JOINTS.index("left_knee"), JOINTS.index("left_ankle")], 2])
    swing = _STEADINESS * walker.sway[0] / legs
    left, right = walker.left.copy(), walker.right.copy()
    left[LIMB_CURVES.index("hip_flexion")] += swing
    right[LIMB_CURVES.index("hip_flexion")] += shift_curve(swing, 0.5)
    return walker._replace(left=left, right=right)


def _curve(named: dict[str, float], curve: str, *, side: float) -> NDArray[np.float64]:
    coefficients = NORMATIVE[curve].copy()
    if curve == "foot_pitch":
        coefficients -= named["bounce"] * HEEL_LIFT
    coefficients[1:] *= 1 + named[f"{curve}_gain"] + side * named.get(f"{curve}_side_gain", 0.0)
    coefficients[0] += named[f"{curve}_mean"] + side * named.get(f"{curve}_side_mean", 0.0)
    coefficients = shift_curve(coefficients, named[f"{curve}_delay"])
    coefficients[1:7] += [named[f"{curve}_{wave}"] for wave in _WAVES]
    coefficients[1:7] += [side * named.get(f"{curve}_side_{wave}", 0.0) for wave in _WAVES]
    return coefficients


def _integrate(velocity: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the coefficients, without a mean, of the periodic path that has a velocity per stride."""
    waves = fit_harmonics(velocity, len(velocity), 1.0, N_HARMONICS)
    steps = 2 * np.pi * np.arange(1, N_HARMONICS + 1)[:, np.newaxis]
    path = np.zeros_like(waves)
    path[1::2], path[2::2] = waves[2::2] / steps, -waves[1::2] / steps
    return path.T


def _posture(walker: Walker, legs: NDArray[np.float64], arms: NDArray[np.float64]) -> Posture:
    """Return the body for the `stride_waves` of legs and trunk and of the arms."""
    # The right side does half a stride later what the left side does.
    sides = walker.left, shift_curve(walker.right, 0.5)
    limbs = [
        np.hstack((curve_values(side[:_N_LEG_CURVES], legs), curve_values(side[_N_LEG_CURVES:], arms)))
        for side in sides
    ]
    return posture(walker.skeleton, curve_values(walker.axial, legs), *limbs)


def walker_markers(
    walker: Walker,
    legs: NDArray[np.float64],
    arms: NDArray[np.float64],
    leg_amplitude: NDArray[np.float64] | float = 1.0,
    arm_amplitude: NDArray[np.float64] | float = 1.0,
) -> NDArray[np.float64]:
    """Return a walker on the treadmill, shape (n_frames, 15, 3), in metres, with the floor at z = 0.

    Parameters
    ----------
    walker : Walker
        From `make_walker`.
    legs, arms : ndarray of shape (n_frames,)
        Phase of legs and trunk, and of the arms, in strides from the heel strike of the left foot.
    leg_amplitude, arm_amplitude : float or ndarray of shape (n_frames,), default 1.0
        Factor on the excursions.

    Returns
    -------
    ndarray of shape (n_frames, 15, 3)
    """
    leg_waves = stride_waves(legs, leg_amplitude)
    body = _posture(walker, leg_waves, stride_waves(arms, arm_amplitude))
    sway = curve_values(walker.sway, leg_waves)
    pelvis = np.column_stack((sway, stance_height(body.soles, support(legs))))
    return body.markers + pelvis[:, np.newaxis]


def stride_features(parameters: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the 226 features of the exact stride of a parameter vector, shape (n_features,), named by `FEATURES`."""
    walker = make_walker(parameters)
    channels = walker_markers(walker, _CYCLE, _CYCLE).reshape(len(_CYCLE), -1)  # (n_phases, 45)
    coefficients = fit_harmonics(channels, len(_CYCLE), 1.0, 2)
    weights = np.zeros(channels.shape[1])
    weights[[3 * TROJE15.index("left_ankle"), 3 * TROJE15.index("right_ankle")]] = 1.0, -1.0
    aligned = shift_phase(coefficients, reference_phase(coefficients, weights))
    return np.append(aligned.ravel(), walker.frequency)  # (5, 45) -> (225,), one block after the other
