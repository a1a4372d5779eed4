"""Climbing to the transform of largest objective: rows in turn, then Newton steps for all of them at once.

    f(W) = beta log |det A| - 1/2 sum_i (w_i G_i w_i' - 2 w_i k_i'),    W = (A b)

Rows in turn (Gales 1998): with p_i the cofactors of row i, det A = a_i p_i', the best row given the others is

    w_i = (alpha p_i + k_i) G_i^-1    with alpha > 0 from    alpha^2 p_i G_i^-1 p_i' + alpha p_i G_i^-1 k_i' = beta

Here p_i is column i of A^-1, so that the new a_i p_i' = beta / alpha is what det A is multiplied by: it stays positive,
and A^-1 follows by a change of rank one. Each row is a concave problem of its own, and f never falls. All of f is not
concave, and rows that depend on each other make the climb slow, so its end is left to Newton steps, solved by
conjugate gradients with the rows' own Hessians as preconditioner and kept short where f is not concave.
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

__all__ = ["Problem", "ascend_rows", "make_problem", "objective", "polish"]

_MAX_PRODUCTS = 4000  # with the Hessian, in all
_VANISHED = 1e-24  # of the terms of f: a gain that is less is none
_ROUNDING = 1e-13  # of the terms of f: what f may fall by in a step that rounding decides


class Problem(NamedTuple):
    """What f is made of, and the inverses of G_i.

    Attributes
    ----------
    n_volumes : float
        beta.
    quadratic, inverses : ndarray of shape (n_channels, n_channels + 1, n_channels + 1)
        G_i and their inverses.
    linear : ndarray of shape (n_channels, n_channels + 1)
        k_i.
    """

    n_volumes: float
    quadratic: NDArray[np.float64]
    inverses: NDArray[np.float64]
    linear: NDArray[np.float64]


def make_problem(
    n_volumes: float, quadratic: NDArray[np.float64], linear: NDArray[np.float64]
) -> tuple[Problem, float]:
    """Return the problem, and the largest condition number of any G_i with ones on its diagonal (infinity: singular).

    The condition is bounded by that in the Frobenius norm.
    """
    diagonals = np.sqrt(np.einsum("ijj->ij", quadratic))
    if not (diagonals > 0).all():
        return Problem(n_volumes, quadratic, np.zeros_like(quadratic), linear), np.inf
    scaled = quadratic / (diagonals[:, :, np.newaxis] * diagonals[:, np.newaxis])
    try:
        np.linalg.cholesky(scaled)
        inverses = np.linalg.inv(scaled)
    except np.linalg.LinAlgError:
        return Problem(n_volumes, quadratic, np.zeros_like(quadratic), linear), np.inf
    condition = (np.linalg.norm(scaled, axis=(1, 2)) * np.linalg.norm(inverses, axis=(1, 2))).max()
    inverses /= diagonals[:, :, np.newaxis] * diagonals[:, np.newaxis]
    inverses = 0.5 * (inverses + inverses.transpose(0, 2, 1))
    return Problem(n_volumes, quadratic, np.ascontiguousarray(inverses), linear), float(condition)


def objective(problem: Problem, rows: NDArray[np.float64]) -> float:
    """Return f(W); minus infinity unless det A > 0. `rows` is W, of shape (n_channels, n_channels + 1)."""
    return _objective_and_size(problem, rows)[0]


def _objective_and_size(problem: Problem, rows: NDArray[np.float64]) -> tuple[float, float]:
    """Return f and the size of its terms, of which rounding is a part."""
    sign, log_volume = np.linalg.slogdet(rows[:, :-1])
    if sign <= 0:
        return -np.inf, np.inf
    terms = rows * (_products(problem.quadratic, rows) - 2 * problem.linear)
    volume = problem.n_volumes * float(log_volume)
    return volume - 0.5 * float(terms.sum()), abs(volume) + float(np.abs(terms).sum())


def ascend_rows(
    problem: Problem, rows: NDArray[np.float64], *, tolerance: float, max_sweeps: int
) -> tuple[NDArray[np.float64], list[float]]:
    """Return W after sweeps over all rows, and f at the start and after each.

    Stops when a sweep gains less than `tolerance` nats a volume, or after `max_sweeps`.
    """
    rows = np.array(rows, dtype=np.float64)
    solutions = _products(problem.inverses, problem.linear)
    history = [objective(problem, rows)]
    for _ in range(max_sweeps):
        _sweep(rows, np.linalg.inv(rows[:, :-1]), problem.inverses, solutions, problem.n_volumes)
        history.append(objective(problem, rows))
        if history[-1] - history[-2] < tolerance * problem.n_volumes:
            break
    return rows, history


@njit(cache=True, nogil=True, fastmath={"reassoc", "contract"})
def _sweep(rows, inverse, inverses, solutions, count):
    """Replace each row by its best given the others; `inverse` is A^-1 and kept so, `solutions` are k_i G_i^-1."""
    n_channels = len(rows)
    cofactors, change, weights = np.empty(n_channels), np.empty(n_channels), np.empty(n_channels)
    for i in range(n_channels):
        square = linear = 0.0
        for j in range(n_channels):
            cofactors[j] = inverse[j, i]
        direction = np.zeros(n_channels + 1)
        for j in range(n_channels):
            cofactor, row = cofactors[j], inverses[i, j]
            for k in range(n_channels + 1):
                direction[k] += cofactor * row[k]
        for j in range(n_channels):
            square += direction[j] * cofactors[j]
            linear += solutions[i, j] * cofactors[j]
        root = np.sqrt(linear * linear + 4.0 * square * count)
        alpha = 2.0 * count / (linear + root) if linear > 0.0 else (root - linear) / (2.0 * square)
        for j in range(n_channels + 1):
            updated = solutions[i, j] + alpha * direction[j]
            if j < n_channels:
                change[j] = updated - rows[i, j]
            rows[i, j] = updated
        # Sherman and Morrison: A^-1 - (A^-1 e_i) (change A^-1) / (1 + change A^-1 e_i), the last being a_i p_i'.
        weights[:] = 0.0
        for j in range(n_channels):
            for k in range(n_channels):
                weights[k] += change[j] * inverse[j, k]
        for j in range(n_channels):
            factor = cofactors[j] * alpha / count
            for k in range(n_channels):
                inverse[j, k] -= factor * weights[k]


class _Model(NamedTuple):
    """f near a W: its slope, and what its Hessian is made of.

    M is the Hessian of each row by itself, G_i + beta p_i' p_i, which measures lengths and preconditions.
    """

    problem: Problem
    inverse: NDArray[np.floating]  # A^-1
    gradient: NDArray[np.float64]  # (beta A^-T, 0) + k_i - w_i G_i
    directions: NDArray[np.float64]  # p_i G_i^-1
    shares: NDArray[np.float64]  # beta / (1 + beta p_i G_i^-1 p_i'), of Sherman and Morrison

    def precondition(self, vector: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return M^-1 times a vector of the shape of W."""
        along = self.shares * (self.directions * vector).sum(axis=1)
        return _products(self.problem.inverses, vector) - along[:, np.newaxis] * self.directions

    def curve(self, vector: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return minus the Hessian of f times a vector: V_i G_i + beta (A^-1 V A^-1)'."""
        product = _products(self.problem.quadratic, vector)
        product[:, :-1] += self.problem.n_volumes * (self.inverse @ vector[:, :-1] @ self.inverse).T
        return product


def _make_model(problem: Problem, rows: NDArray[np.float64]) -> _Model:
    inverse = np.linalg.inv(rows[:, :-1])
    gradient = problem.linear - _products(problem.quadratic, rows)
    gradient[:, :-1] += problem.n_volumes * inverse.T
    directions = (problem.inverses[:, :, :-1] @ inverse.T[..., np.newaxis])[..., 0]
    squares = np.einsum("ij,ji->i", directions[:, :-1], inverse)
    return _Model(problem, inverse, gradient, directions, problem.n_volumes / (1.0 + problem.n_volumes * squares))


def polish(problem: Problem, rows: NDArray[np.float64]) -> tuple[NDArray[np.float64], float]:
    """Return W where the gradient of f vanishes, and what rows by themselves could still gain, in nats.

    Newton steps of bounded length (Steihaug 1983): the bound grows while the quadratic model of f predicts gains well.
    """
    value, size = _objective_and_size(problem, rows)
    radius, left, before = np.inf, _MAX_PRODUCTS, np.inf
    while True:
        model = _make_model(problem, rows)
        gain = 0.5 * float((model.gradient * model.precondition(model.gradient)).sum())
        slack = _ROUNDING * size
        if gain < _VANISHED * size or left <= 0 or slack > gain > 0.25 * before:
            return rows, gain
        before = gain
        radius = min(radius, 1e3 * np.sqrt(gain))
        step = _bounded_step(model, radius, precision=min(0.3, (gain / problem.n_volumes) ** 0.5), most=left)
        left -= step.n_products
        reached, reached_size = _objective_and_size(problem, rows + step.change)
        ratio = (reached - value + slack) / (step.predicted + slack)
        if ratio < 0.25:
            radius = 0.25 * step.length
        elif ratio > 0.75 and step.at_edge:
            radius *= 3.0
        if ratio > 1e-3:
            rows, value, size = rows + step.change, reached, reached_size
        elif step.predicted < slack:
            return rows, gain


class _Step(NamedTuple):
    change: NDArray[np.float64]
    predicted: float  # gain of the quadratic model, in nats
    length: float  # in the metric M
    at_edge: bool
    n_products: int  # with the Hessian


def _bounded_step(model: _Model, radius: float, *, precision: float, most: int) -> _Step:
    """Return the step to the top of the quadratic model, or to the bound on the way there (conjugate gradients)."""
    change, residual = np.zeros_like(model.gradient), model.gradient
    direction = ahead = model.precondition(residual)
    start = energy = float((residual * ahead).sum())
    square, along, across, n_products, at_edge = 0.0, 0.0, energy, 0, False  # of change, of both, of direction, in M
    while energy > precision**2 * start and n_products < most and not at_edge:
        curved = model.curve(direction)
        n_products += 1
        curvature = float((direction * curved).sum())
        length = energy / curvature if curvature > 0 else np.inf
        at_edge = curvature <= 0 or square + length * (2 * along + length * across) >= radius**2
        if at_edge:
            length = (np.sqrt(along**2 + across * (radius**2 - square)) - along) / across
        change, residual = change + length * direction, residual - length * curved
        square += length * (2 * along + length * across)
        ahead = model.precondition(residual)
        energy, share = float((residual * ahead).sum()), 1.0 / energy
        share *= energy
        along, across = share * (along + length * across), energy + share**2 * across
        direction = ahead + share * direction
    predicted = 0.5 * float(((model.gradient + residual) * change).sum())
    return _Step(change, predicted, float(np.sqrt(square)), at_edge, n_products)


def _products(matrices: NDArray[np.float64], rows: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return matrix i times row i, of shape (n_channels, n_channels + 1)."""
    return (matrices @ rows[..., np.newaxis])[..., 0]
