"""What is drawn at random for displays of dots: places, phases, periods and clones.

Each function takes uniform random numbers in [0, 1) and says how many: a scrambling is a plain function of them. They
come from `numpy.random.RandomState.random_sample`, whose stream numpy keeps as it is (NEP 19) and which, unlike its
whole numbers, is the same on every machine.
"""

import numpy as np
from numpy.typing import NDArray

from eigenwalker._validation import check_choice
from eigenwalker.display._numbers import check_number
from eigenwalker.display.point_lights import Reach

__all__ = [
    "choose_clones",
    "rectangle",
    "scatter_means",
    "scatter_periods",
    "scatter_phases",
    "scrambling_directions",
]


def scatter_means(
    means: NDArray[np.floating],
    reach: Reach,
    box: NDArray[np.floating],
    uniform: NDArray[np.floating],
    *,
    amount: float = 1.0,
) -> NDArray[np.float64]:
    r"""Return means that are moved towards places drawn at random in a box.

    .. math:: m'_i = m_i + a (r_i - m_i)

    where r is uniform among the means from which the whole path of the dot stays inside the box. With a = 1 all
    dots are anywhere in the box, with a < 1 the same part of the way there; nothing but the mean changes.

    Parameters
    ----------
    means : ndarray of shape (n_dots, n_axes)
        Where the dots' paths are centered.
    reach : Reach
        How far the paths reach around them.
    box : ndarray of shape (2, n_axes)
        Its lowest and highest corner.
    uniform : ndarray of shape (n_dots, n_axes)
        Random numbers.
    amount : float, default 1.0
        The a of the formula, from 0 for none to 1.

    Returns
    -------
    ndarray of shape (n_dots, n_axes)

    Raises
    ------
    ValueError
        If a path does not fit into the box.
    """
    lowest, highest = box[0] + (means - reach.lowest), box[1] - (reach.highest - means)
    room = highest - lowest
    if (room < -1e-9).any():
        longest, sides = (reach.highest - reach.lowest).max(axis=0), box[1] - box[0]
        raise ValueError(
            f"area must have room for every dot's own path, at least {' x '.join(f'{side:.3g}' for side in longest)} "
            f"m, got {' x '.join(f'{side:.3g}' for side in sides)} m"
        )
    return means + amount * (lowest + uniform * room - means)


def scatter_phases(
    phases: NDArray[np.floating], uniform: NDArray[np.floating], *, amount: float = 1.0
) -> NDArray[np.float64]:
    """Return phases, in strides, moved by up to half of `amount` either way: phase + amount (u - 1/2).

    With amount 1 every phase is equally likely. Shapes (n_dots,).
    """
    return phases + amount * (uniform - 0.5)


def scatter_periods(
    frequencies: NDArray[np.floating], uniform: NDArray[np.floating], *, amount: float = 1.0
) -> NDArray[np.float64]:
    """Return frequencies, in hertz, whose periods are multiplied by (1 + amount) ** (2 u - 1).

    With amount 1 periods are from half to twice as long, and the logarithm of that factor is uniform. Shapes (n_dots,).
    """
    return frequencies / (1 + amount) ** (2 * uniform - 1)


def choose_clones(n_clones: int, uniform: NDArray[np.floating]) -> NDArray[np.intp]:
    """Return of which dot each clone is: all dots equally often, those of an incomplete round drawn at random.

    Parameters
    ----------
    n_clones : int
        How many are needed.
    uniform : ndarray of shape (n_dots,)
        Random numbers; in an incomplete round the dots with the smallest ones are cloned.

    Returns
    -------
    ndarray of shape (n_clones,)

    Examples
    --------
    >>> import numpy as np
    >>> from eigenwalker.display.scrambling import choose_clones
    >>> choose_clones(5, np.array([0.9, 0.2, 0.4]))
    array([0, 1, 2, 1, 2])
    """
    n_rounds, n_left = divmod(n_clones, len(uniform))
    left = np.sort(np.argsort(uniform, kind="stable")[:n_left])
    return np.concatenate((np.tile(np.arange(len(uniform)), n_rounds), left))


def rectangle(area: tuple[float, float]) -> NDArray[np.float64]:
    """Return the rectangle of a width and a height around zero, shape (2, 2)."""
    if not isinstance(area, (tuple, list, np.ndarray)) or len(area) != 2:
        raise ValueError(f"area must be (width, height) in metres, got {area!r}")
    half = np.array([check_number(side, "area", above=0, unit="metres") / 2 for side in area])
    return np.stack((-half, half))


def scrambling_directions(how: str, axes: NDArray[np.floating]) -> NDArray[np.float64]:
    """Return the directions in which a scrambling moves dots, unit vectors of shape (n_directions, 3).

    Parameters
    ----------
    how : {"area", "horizontal", "vertical", "volume", "x", "y", "z"}
        Both or one of those of the picture, all or one of the walker's.
    axes : ndarray of shape (3, 3)
        Those of the picture, to the right and up first.
    """
    right, up = np.asarray(axes, dtype=np.float64)[:2]
    x, y, z = np.eye(3)
    directions = {
        "area": (right, up),
        "horizontal": (right,),
        "vertical": (up,),
        "volume": (x, y, z),
        "x": (x,),
        "y": (y,),
        "z": (z,),
    }
    check_choice(how, directions, name="how")
    return np.array(directions[how])
