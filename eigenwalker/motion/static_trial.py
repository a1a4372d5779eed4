"""What a static trial adds to a walk: markers that were taken off, and the lengths of the legs."""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from eigenwalker._validation import WalkError
from eigenwalker.motion.rig import Rig, Segment, locate, sources
from eigenwalker.motion.rigid import fit_rigid
from eigenwalker.motion.skeleton import MarkerSet

if TYPE_CHECKING:
    from eigenwalker.motion.walk import Walk

__all__ = ["carry_markers", "hold_legs", "hold_lengths"]

_THINNEST = 0.005  # metres, root mean square, that a cluster must reach to both sides of its longest axis
_WORST_FIT = 0.03  # metres, root mean square; skin moves by 1 to 2 cm, another person's cluster by more
_LEG = ("hip", "knee", "ankle")
_ROUNDS = 20


def carry_markers(walk: "Walk", static: "Walk", segments: Iterable[Segment]) -> "Walk":
    """Return a walk with the markers that only its static trial has, carried by clusters of markers on the same bone.

    In each frame the cluster of a segment is laid over the same markers of the static trial by the rigid motion that
    fits best in the sense of least squares (`fit_rigid`), and that motion brings the other markers of the bone
    along (Cappozzo, Catani, Della Croce & Leardini 1995, Clin. Biomech. 10, 171-178).

    Parameters
    ----------
    walk : Walk
        With the markers of the clusters. Where one has a gap, so have the markers it carries.
    static : Walk
        The same person with the same markers and some more, standing still: each marker's mean place counts.
        Where the person stands and faces does not matter.
    segments : iterable of Segment
        Clusters, and what each carries. They are worked through in order, so that a cluster may use what was carried
        before. A marker that more than one segment carries is put in the middle. A marker that the walk has is kept.

    Returns
    -------
    Walk
        With the markers of `walk` and then the carried ones.

    Raises
    ------
    WalkError
        If markers are missing, if a cluster lies on one line, or if it has another shape in the walk than in the
        static trial, by more than 30 mm.

    Examples
    --------
    >>> import numpy as np
    >>> from eigenwalker.motion import MarkerSet, Segment, Walk, carry_markers
    >>> body = np.array([[[0.0, 0.1, 0.9], [0.1, 0.1, 0.7], [0.0, 0.1, 0.5], [0.0, 0.0, 0.5]]])
    >>> static = Walk(body, 100, MarkerSet(("THI1", "THI2", "KNEE LAT", "KNEE MED")))
    >>> walk = Walk(body[:, :3] + [2.0, 0.0, 0.0], 100, MarkerSet(("THI1", "THI2", "KNEE LAT")))
    >>> thigh = Segment(("THI1", "THI2", "KNEE LAT"), ("KNEE MED",))
    >>> carry_markers(walk, static, [thigh]).marker("KNEE MED").round(9) + 0.0
    array([[2. , 0. , 0.5]])
    """
    own = walk.marker_set.names
    standing = _standing(static)
    carried: dict[str, list[NDArray[np.float64]]] = {}
    for segment in segments:
        wanted = [name for name in segment.carried if name not in own and name in static.marker_set.names]
        if not wanted:
            continue
        names, positions = _with(own, walk.positions, carried)
        rotation, translation = _motion(segment, names, positions, static.marker_set.names, standing, walk, static)
        for name in wanted:
            place = standing[0, static.marker_set.index(name)]
            if not np.isfinite(place).all():
                raise WalkError(f"static trial {static.name!r}: marker {name} is never seen in the static trial")
            carried.setdefault(name, []).append(rotation @ place + translation)
    names, positions = _with(own, walk.positions, carried)
    return replace(walk, positions=positions, marker_set=MarkerSet(names, walk.marker_set.sticks))


def _standing(static: "Walk") -> NDArray[np.float64]:
    """Return the mean place of each marker as a single frame, shape (1, n_markers, 3); NaN where it was never seen."""
    seen = np.isfinite(static.positions).all(axis=2)  # (n_frames, n_markers)
    total = np.where(seen[..., np.newaxis], static.positions, 0.0).sum(axis=0, dtype=np.float64)
    count = seen.sum(axis=0)[:, np.newaxis]
    return np.where(count > 0, total / np.maximum(count, 1), np.nan)[np.newaxis]


def _with(
    own: tuple[str, ...], positions: NDArray[np.floating], carried: dict[str, list[NDArray[np.float64]]]
) -> tuple[tuple[str, ...], NDArray[np.floating]]:
    """Return names and positions with the markers carried so far, each midway between where its segments put it."""
    paths = [np.mean(ways, axis=0)[:, np.newaxis] for ways in carried.values()]
    return (*own, *carried), np.concatenate([positions, *paths], axis=1)


def _motion(
    segment: Segment,
    names: Sequence[str],
    positions: NDArray[np.floating],
    static_names: Sequence[str],
    standing: NDArray[np.float64],
    walk: "Walk",
    static: "Walk",
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the rotation and translation of a segment from the static trial to each frame of the walk."""
    what = (
        f"walk {walk.name!r} with static trial {static.name!r}: the cluster that carries {', '.join(segment.carried)}"
    )
    needed = sorted(name for place in segment.cluster for name in sources(place))
    for title, there in (("walk", names), ("static trial", static_names)):
        absent = [name for name in needed if name not in there]
        if absent:
            raise WalkError(f"{what} needs {', '.join(absent)}, which the {title} lacks; it has {', '.join(there)}")
    source = np.concatenate([locate(place, static_names, standing) for place in segment.cluster])  # (n_places, 3)
    target = np.stack([locate(place, names, positions) for place in segment.cluster], axis=1)
    if not np.isfinite(source).all():
        raise WalkError(f"{what} ({', '.join(needed)}) is never seen as a whole in the static trial")
    spread = np.linalg.svd(source - source.mean(axis=0), compute_uv=False)
    if len(source) < 3 or spread[1] < _THINNEST * np.sqrt(len(source)):
        raise WalkError(
            f"{what} ({', '.join(needed)}) must have at least three markers that are not on one line, "
            "else nothing tells how it turns about that line; name a marker off it as well"
        )
    rotation, translation = fit_rigid(source, target)
    _check_shape(source @ np.swapaxes(rotation, 1, 2) + translation[:, np.newaxis] - target, what, needed)
    return rotation, translation


def _check_shape(rest: NDArray[np.float64], what: str, needed: Sequence[str]) -> None:
    """Raise if a cluster, shape (n_frames, n_places, 3) of what the rigid motion leaves, has changed its shape."""
    sizes = np.sqrt((rest**2).sum(axis=2).mean(axis=1))
    sizes = sizes[np.isfinite(sizes)]
    if sizes.size and np.median(sizes) > _WORST_FIT:
        raise WalkError(
            f"{what} ({', '.join(needed)}) has another shape in the walk than in the static trial, by "
            f"{1000 * np.median(sizes):.0f} mm, expected up to {1000 * _WORST_FIT:.0f} mm; "
            "is it the same person with the same markers?"
        )


def hold_legs(positions: NDArray[np.float64], markers: Sequence[str], rig: Rig, static: "Walk") -> NDArray[np.float64]:
    """Return markers whose thighs and shanks are as long as in the static trial.

    Skin slides over the bones, by up to 2 cm at the hip, and hips, knees and ankles placed one by one let the bones
    grow and shrink with it. Each leg's three centres are moved as little as possible, in the sense of least squares,
    so that the bones keep their lengths: the joint constraint of Lu & O'Connor 1999 (J. Biomech. 32, 129-134), on
    joint centres in place of their markers. The pelvis moves along with the mean of its hips.

    Parameters
    ----------
    positions : ndarray of shape (n_frames, n_markers, 3)
        Where the markers are.
    markers : sequence of str
        Their names, with the 15 among them.
    rig : Rig
        Places hips, knees and ankles in the static trial.
    static : Walk
        The static trial.
    """
    standing = _standing(static)
    held = positions.copy()
    for side in ("left", "right"):
        chain = [f"{side}_{joint}" for joint in _LEG]
        (still,) = rig.place(static.marker_set.names, standing, chain)
        lengths = np.linalg.norm(np.diff(still, axis=0), axis=1)
        if not np.isfinite(lengths).all():
            raise WalkError(f"static trial {static.name!r}: the markers of the {side} leg are never seen")
        columns = [markers.index(marker) for marker in chain]
        held[:, columns] = hold_lengths(positions[:, columns], lengths)
    hips = [markers.index(f"{side}_hip") for side in ("left", "right")]
    held[:, markers.index("pelvis")] += (held - positions)[:, hips].mean(axis=1)
    return held


def hold_lengths(chain: NDArray[np.float64], lengths: NDArray[np.float64]) -> NDArray[np.float64]:
    r"""Return the chain with sticks of given lengths that is nearest to a chain of three points, in each frame.

    The minimum of :math:`\sum_j \|p_j - q_j\|^2` subject to :math:`\|p_{j+1} - p_j\| = l_j`, by Newton steps on the
    linearised constraints from q (sequential quadratic programming).

    Parameters
    ----------
    chain : ndarray of shape (n_frames, 3, 3)
        Three points q a frame, such as hip, knee and ankle.
    lengths : ndarray of shape (2,)
        Lengths l of the two sticks, positive.

    Returns
    -------
    ndarray of shape (n_frames, 3, 3)
    """
    held = chain.copy()
    for _ in range(_ROUNDS):
        sticks = np.diff(held, axis=1)  # (n_frames, 2, 3)
        size = np.linalg.norm(sticks, axis=2)
        unit = sticks / size[..., np.newaxis]
        # How much longer than l the sticks of q are, to first order about the chain that is held.
        excess = size - lengths + np.sum(unit * (np.diff(chain, axis=1) - sticks), axis=2)
        cosine = np.sum(unit[:, 0] * unit[:, 1], axis=1)
        first, second = excess.T
        pull = np.stack((2 * first + cosine * second, cosine * first + 2 * second)) / (4 - cosine**2)
        force = pull.T[..., np.newaxis] * unit  # (n_frames, 2, 3), along the sticks
        before, held = held, chain + np.stack((force[:, 0], force[:, 1] - force[:, 0], -force[:, 1]), axis=1)
        if not (np.abs(held - before) > 1e-12).any():
            break
    return held
