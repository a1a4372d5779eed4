"""Means of walkers that do not depend on who happened not to rate them."""

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

__all__ = ["additive_means", "linked_parts"]


def additive_means(ratings: NDArray[np.float64]) -> NDArray[np.float64]:
    r"""Return the mean that each walker would have, had everybody rated it.

    Least squares fit to the ratings there are

    .. math:: r_{w c} = a_w + b_c + err

    with a walker effect a and an effect b of who rated it in which view (Yates 1934, Journal of the American
    Statistical Association 29, 51-66: the method of fitting constants). The mean of a walker is a_w plus the mean of
    all b, each of the same weight. Without gaps it is the plain mean.

    Parameters
    ----------
    ratings : ndarray of shape (n_walkers, n_columns)
        One column an observer and view; NaN where there is no rating. Every row and column has one, and all are
        linked, see `linked_parts`.

    Returns
    -------
    ndarray of shape (n_walkers,)

    Examples
    --------
    >>> harsh_skips_the_last = np.array([[3.0, 1.0], [4.0, 2.0], [5.0, np.nan]])
    >>> additive_means(harsh_skips_the_last).round(6)
    array([2., 3., 4.])
    """
    there = ~np.isnan(ratings)
    values = np.where(there, ratings, 0.0)
    shares = there / there.sum(axis=0)
    # Normal equations of a with b eliminated, and a constraint: the a sum to zero.
    equations = np.diag(there.sum(axis=1)) - shares @ there.T + 1.0
    effects = np.linalg.solve(equations, values.sum(axis=1) - shares @ values.sum(axis=0))
    columns = (values.sum(axis=0) - effects @ there) / there.sum(axis=0)
    return effects + columns.mean()


def linked_parts(ratings: NDArray[np.float64]) -> NDArray[np.int_]:
    """Return to which part each walker belongs; walkers of different parts have no observer and view in common.

    Parameters
    ----------
    ratings : ndarray of shape (n_walkers, n_columns)
        NaN where there is no rating.

    Returns
    -------
    ndarray of shape (n_walkers,)
        Numbers from 0. Walkers of one part can be compared, directly or over others between them.
    """
    there = ~np.isnan(ratings)
    walkers, columns = np.nonzero(there)
    n_walkers, n_nodes = len(there), sum(there.shape)
    links = csr_array((np.ones(len(walkers)), (walkers, n_walkers + columns)), shape=(n_nodes, n_nodes))
    return connected_components(links, directed=False)[1][:n_walkers]
