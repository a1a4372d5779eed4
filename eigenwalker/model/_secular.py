"""The eigenvalues and eigenvectors of a diagonal matrix after a change of rank one, without a dense eigenproblem.

The eigenvalues of diag(d) - z z' are the roots of the secular equation 1 = sum_l z_l^2 / (d_l - mu). One lies between
each two poles d_l, and the eigenvector of each is (diag(d) - mu)^-1 z (Golub 1973). Three things keep that exact:

- A root is held as the nearest pole and the distance from it, so that no d_l - mu suffers from cancellation.
- Where z_l is nothing, or two poles are one, the pole itself is an eigenvalue (deflation).
- With all roots at hand z is replaced by the vector for which these roots are exact (Gu and Eisenstat 1994), and the
  eigenvectors are orthogonal to rounding however close the roots are. With only the first few roots at hand their
  error is estimated, and where it exceeds 1e-13 all roots are found after all.

The loops are plain because they compile in a fifth of the time of the same in array expressions.
"""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["add_rank_one", "subtract_each", "subtract_rank_one"]

_EPS = float(np.finfo(np.float64).eps)
_LARGEST_ERROR = 1e-13  # of an eigenvector found without all the others
_MAX_STEPS = 300


def add_rank_one(
    poles: NDArray[np.float64], vector: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return all eigenvalues of diag(poles) + vector vector', and their eigenvectors; see `subtract_rank_one`."""
    # The same for diag(-poles) - vector vector', with everything in reverse.
    values, vectors = subtract_rank_one(-poles[::-1], vector[::-1], len(poles))
    return -values[::-1], vectors[::-1, ::-1]


def subtract_rank_one(
    poles: NDArray[np.float64], vector: NDArray[np.float64], n_roots: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the largest eigenvalues of diag(poles) - vector vector', and their eigenvectors.

    Parameters
    ----------
    poles : ndarray of shape (n_poles,)
        In descending order.
    vector : ndarray of shape (n_poles,)
        What is subtracted.
    n_roots : int
        How many eigenpairs are wanted.

    Returns
    -------
    eigenvalues : ndarray of shape (n_roots,)
        In descending order.
    eigenvectors : ndarray of shape (n_roots, n_poles)
        A row each.
    """
    values, vectors = subtract_each(poles, vector[np.newaxis], n_roots)
    return values[0], vectors[0]


def subtract_each(
    poles: NDArray[np.float64], rows: NDArray[np.float64], n_roots: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the same for each row, subtracted alone, shapes (n_rows, n_roots) and (n_rows, n_roots, n_poles)."""
    return _subtract_each(np.ascontiguousarray(poles), np.ascontiguousarray(rows), n_roots)


# Only this function is called from Python and kept on disk: numba mixes up functions that are both kept by themselves
# and within another.
@njit(cache=True, nogil=True, error_model="numpy")
def _subtract_each(poles, rows, n_roots):
    n_poles = len(poles)
    values, vectors = np.empty((len(rows), n_roots)), np.zeros((len(rows), n_roots, n_poles))
    for row in range(len(rows)):
        kept, kept_poles, kept_vector, turns = _deflate(poles, rows[row])
        n_kept = len(kept)
        n_found = n_kept if n_roots >= n_poles else min(n_kept, n_roots + 1)
        while True:
            roots, distances = _find_roots(kept_poles, kept_vector, n_found)
            if n_found == n_kept:
                _match_vector(kept_poles, distances, kept_vector)
                break
            if _error_of_vectors(roots, distances, kept_vector) <= _LARGEST_ERROR:
                break
            n_found = n_kept
        _collect(poles, kept, turns, roots, distances, kept_vector, values[row], vectors[row])
    return values, vectors


@njit(nogil=True, error_model="numpy", inline="always")
def _deflate(poles, vector):
    """Return which poles are kept, these poles, their entries of the vector, and how equal poles were turned.

    In a plane of two equal poles a rotation changes the vector alone, and makes one of its entries zero: rows
    (first, second, cosine, sine).
    """
    n_poles = len(poles)
    kept, turns = np.empty(n_poles, dtype=np.int64), np.empty((n_poles, 4))
    kept_poles, kept_vector = np.empty(n_poles), np.empty(n_poles)
    n_kept = n_turns = 0
    square = 0.0
    for pole in range(n_poles):
        square += vector[pole] ** 2
    norm, largest = math.sqrt(square), max(abs(poles[0]), abs(poles[-1]))
    for pole in range(n_poles):
        entry, size = vector[pole], abs(poles[pole])
        # Leaving an entry z_l out moves the matrix by |z_l| |z|.
        if abs(entry) * norm <= _EPS * max(size, _EPS * largest):
            continue
        if n_kept > 0 and kept_poles[n_kept - 1] - poles[pole] <= 4 * _EPS * max(size, abs(kept_poles[n_kept - 1])):
            n_kept -= 1
            length = math.sqrt(kept_vector[n_kept] ** 2 + entry**2)
            turns[n_turns, 0], turns[n_turns, 1] = kept[n_kept], pole
            turns[n_turns, 2], turns[n_turns, 3] = entry / length, kept_vector[n_kept] / length
            n_turns += 1
            entry = length
        kept[n_kept], kept_poles[n_kept], kept_vector[n_kept] = pole, poles[pole], entry
        n_kept += 1
    return kept[:n_kept], kept_poles[:n_kept], kept_vector[:n_kept], turns[:n_turns]


@njit(nogil=True, error_model="numpy", inline="always")
def _find_roots(poles, vector, n_found):
    """Return the first roots, and d_l - mu for each of them, a row a root."""
    n_poles = len(poles)
    roots, distances = np.empty(n_found), np.empty((n_found, n_poles))
    weights, gaps = np.empty(n_poles), np.empty(n_poles)
    for pole in range(n_poles):
        weights[pole] = vector[pole] ** 2
    for position in range(n_found):
        nearest, offset = _find_root(poles, weights, position, gaps)
        roots[position] = poles[nearest] + offset
        for pole in range(n_poles):
            distances[position, pole] = (poles[pole] - poles[nearest]) - offset
    return roots, distances


@njit(nogil=True, error_model="numpy", inline="always")
def _find_root(poles, weights, position, gaps):
    """Return the nearest pole, and the distance from it, of the root below pole `position`; `gaps` is scratch space."""
    n_poles = len(poles)
    is_last = position + 1 == n_poles
    width = 0.0
    if is_last:
        for pole in range(n_poles):
            width += weights[pole]
    else:
        width = poles[position] - poles[position + 1]
    nearest, low, high, offset = position, -width, 0.0, -0.5 * width
    for pole in range(n_poles):
        gaps[pole] = poles[pole] - poles[nearest]
    for step_number in range(_MAX_STEPS):
        above, above_slope = _sums(weights, gaps, offset, 0, position + 1)
        below, below_slope = _sums(weights, gaps, offset, position + 1, n_poles)
        value = 1.0 - above - below  # falls from +inf to -inf between the poles
        if abs(value) <= 4 * _EPS * (1.0 + above - below):
            break
        if step_number == 0 and value < 0.0 and not is_last:  # in the lower half
            nearest, low, high, offset = position + 1, 0.0, width, 0.5 * width
            for pole in range(n_poles):
                gaps[pole] = poles[pole] - poles[nearest]
        if value > 0.0:
            low = offset
        else:
            high = offset
        upper, lower = gaps[position] - offset, 0.0 if is_last else gaps[position + 1] - offset
        proposed = offset + _rational_step(value, above_slope, below_slope, upper, lower)
        if not low < proposed < high:
            proposed = 0.5 * (low + high)
        if proposed == offset or high - low <= _EPS * abs(offset):
            break
        offset = proposed
    return nearest, offset


@njit(nogil=True, error_model="numpy", fastmath={"reassoc", "contract", "nsz"})
def _sums(weights, gaps, offset, start, stop):
    """Return the sum of z_l^2 / (d_l - mu) over some poles, and its slope."""
    total = slope = 0.0
    for pole in range(start, stop):
        inverse = 1.0 / (gaps[pole] - offset)
        term = weights[pole] * inverse
        total += term
        slope += term * inverse
    return total, slope


@njit(nogil=True, error_model="numpy", inline="always")
def _rational_step(value, above_slope, below_slope, upper, lower):
    """Return the step to the root of c - s / (upper - step) - t / (lower - step), NaN for none.

    It agrees with the secular function in value and slope: the poles above as one at distance `upper`, those below as
    one at distance `lower`, 0 for no such pole (Bunch, Nielsen and Sorensen 1978).
    """
    upper_weight, lower_weight = above_slope * upper**2, below_slope * lower**2
    constant = value + above_slope * upper + below_slope * lower
    if lower == 0.0:
        return upper - upper_weight / constant
    linear = constant * (upper + lower) - upper_weight - lower_weight
    product = upper * lower * value
    discriminant = linear**2 - 4.0 * constant * product
    if linear <= 0.0:
        return 2.0 * product / (linear - math.sqrt(discriminant))
    return 0.5 * (linear + math.sqrt(discriminant)) / constant


@njit(nogil=True, error_model="numpy", inline="always")
def _error_of_vectors(roots, distances, vector):
    """Return an estimate of how far from orthogonal the eigenvectors of neighboring roots are.

    An error e of root j tilts its vector towards that of root m by e |q_m . z| / (|q_j . z| |mu_m - mu_j|), and
    1 / (q_j . z)^2 is the slope of the secular function, its sum of z_l^2 / (d_l - mu)^2.
    """
    worst = last_size = last_slope = 0.0
    for position in range(len(roots)):
        size, slope = 1.0, 0.0
        for pole in range(len(vector)):
            term = vector[pole] ** 2 / distances[position, pole]
            size += abs(term)
            slope += term / distances[position, pole]
        if position > 0:
            gap = roots[position - 1] - roots[position]
            worst = max(worst, 4 * _EPS * max(size, last_size) / (math.sqrt(slope * last_slope) * gap))
        last_size, last_slope = size, slope
    return worst


@njit(nogil=True, error_model="numpy", inline="always")
def _match_vector(poles, distances, vector):
    """Change the vector to that for which all roots are exact, z_l^2 = prod_j (d_l - mu_j) / prod_j (d_l - d_j)."""
    n_poles = len(poles)
    squares = np.empty(n_poles)
    for pole in range(n_poles):
        squares[pole] = distances[n_poles - 1, pole]
    for other in range(n_poles - 1):
        for pole in range(n_poles):
            partner = other if other < pole else other + 1
            squares[pole] *= distances[other, pole] / (poles[pole] - poles[partner])
    for pole in range(n_poles):
        vector[pole] = math.copysign(math.sqrt(max(squares[pole], 0.0)), vector[pole])


@njit(nogil=True, error_model="numpy", inline="always")
def _collect(poles, kept, turns, roots, distances, vector, values, vectors):
    """Fill in the largest among the roots and the deflated poles, and their eigenvectors."""
    n_poles, n_kept = len(poles), len(kept)
    weights, entries, is_kept = np.empty(n_kept), np.empty(n_kept), np.zeros(n_poles + 1, dtype=np.bool_)
    for position in range(n_kept):
        weights[position] = vector[position] ** 2
        is_kept[kept[position]] = True
    root = rest = 0
    for row in range(len(values)):
        while is_kept[rest]:
            rest += 1
        if rest == n_poles or (root < len(roots) and roots[root] >= poles[rest]):
            values[row] = roots[root]
            length = math.sqrt(_sums(weights, distances[root], 0.0, 0, n_kept)[1])
            for position in range(n_kept):  # loops apart, so that the divisions are done by many at a time
                entries[position] = vector[position] / (distances[root, position] * length)
            for position in range(n_kept):
                vectors[row, kept[position]] = entries[position]
            root += 1
        else:
            values[row], vectors[row, rest] = poles[rest], 1.0
            rest += 1
    for turn in range(len(turns) - 1, -1, -1):
        first, second, cosine, sine = int(turns[turn, 0]), int(turns[turn, 1]), turns[turn, 2], turns[turn, 3]
        for row in range(len(values)):
            upper, lower = vectors[row, first], vectors[row, second]
            vectors[row, first] = cosine * upper + sine * lower
            vectors[row, second] = cosine * lower - sine * upper
