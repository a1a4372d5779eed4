"""Observers that are not people: answers to a study before anybody was asked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.special import ndtr
from sklearn.utils import check_random_state

from eigenwalker.display._numbers import check_number
from eigenwalker.experiment.answer_columns import ANSWER_COLUMNS
from eigenwalker.experiment.simulated.answer_chances import answer_chances, answer_order, latent_traits
from eigenwalker.experiment.simulated.timing import simulate_timing
from eigenwalker.experiment.stimulus import Stimulus
from eigenwalker.experiment.study import Study
from eigenwalker.experiment.tasks import RatingTask, Task

__all__ = ["simulate_answers"]

_TYPES = {"int": "int64", "float": "float64", "str": "str"}
_SCALE = 6.0  # standard deviations that the buttons of ratings span


def simulate_answers(
    study: Study,
    *,
    truth: Any = None,
    noise: float = 1.0,
    taste: float = 0.5,
    bias: float = 0.5,
    gain: float = 0.2,
    lapse: float = 0.0,
    missing: float = 0.0,
    participants: Sequence[int] | None = None,
    random_state: Any = None,
) -> pd.DataFrame:
    r"""Return the answers of simulated observers to a study, in the table that people's answers come in.

    **Ratings.** With z_w, how much of the trait walker w has, observer o sees in its n-th trial

    .. math:: x = e^{\sigma_g g_o} z_w + \sigma_b b_o + \sigma_t t_{ow} + \sigma_n \epsilon_{on}

    and presses one of m buttons by even cut points that span six standard deviations of z, for six buttons -2, -1, 0, 1
    and 2. g, b, t and epsilon are standard normal, and their sigmas are `gain`, `bias`, `taste` and `noise`: some see
    larger differences than others, or all walkers happier; some have an opinion of a walker that others do not share,
    from whatever viewpoint; and none says the same thing twice. With the defaults single ratings of several observers
    have an intraclass correlation, ICC(2,1), of about 0.37, and their means over three viewpoints one of 0.52.

    **Other answers** are in an order from the worst to the best (`answer_order`), with planted chances p_1, p_2, ... of
    each (`answer_chances`). An observer gives the first one at which their sum is larger than

    .. math:: u = \Phi\!\left(\frac{\sigma_b b_o + \sigma_t t_{ow} + \sigma_n \epsilon_{on}}
              {\sqrt{\sigma_b^2 + \sigma_t^2 + \sigma_n^2}}\right)

    so that over observers the chances are exactly those, while the answers of one observer are alike.

    Parameters
    ----------
    study : Study
        From `build_study`, `make_study` or `read_study`.
    truth : Series, DataFrame, mapping or float, default None
        What is planted. Of ratings the traits of the walkers in standard deviations, 0 in the middle between both
        poles: a Series, or a DataFrame with a column for each trait, by names of stimuli, such as
        ``make_walkers().target[["happy", "nervous"]]``. Of graded answers the mean grade; of naturalness the share of
        "real"; of recognition the share of right answers: by names of stimuli, styles or kinds, or one for all; or a
        DataFrame of the chances of all answers, such as a confusion table. Of a study with several kinds of tasks a
        mapping from their names, ``{"recognition": 0.5, "resemblance": 3.0}``; tasks that are not in it have None.
        None is what people said in the papers, see `answer_chances`, and for ratings walkers that do not differ.
    noise, taste, bias, gain : float, default 1.0, 0.5, 0.5, 0.2
        How much answers vary from trial to trial; from observer to observer about each walker, and about all of them;
        and how much their gains do. The first three in standard deviations of z; of other answers only their ratios
        matter, and without any all observers give the median answer.
    lapse : float, default 0.0
        Share of trials in which an observer presses any button. Attention trials are otherwise answered as they ask.
    missing : float, default 0.0
        Share of trials that are not answered and have no row.
    participants : sequence of int, default None
        Who answers. None is all of the design.
    random_state : int, RandomState or None, default None
        Seed. Each participant has random numbers of its own for each task, so that answers stay the same when others
        are added, and neither lapses nor missing answers change the rest.

    Returns
    -------
    DataFrame
        With the columns and types of `ANSWER_COLUMNS`, practice and attention trials included; what `read_answers`
        would return. Times are plausible and mean nothing; no frames are dropped.

    Raises
    ------
    ValueError
        If the truth does not fit the study, with all faults at once, a number is out of range, or a participant is not
        in the design.

    Examples
    --------
    Three observers of 80 walkers, as in Troje 2002, section 4:

    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.experiment import RatingTask, make_study, ratings_to_traits, simulate_answers
    >>> walkers = make_walkers(80, duration=4, frame_rate=60, random_state=0)
    >>> study = make_study(RatingTask(("sad", "happy")), walks=walkers.data, n_participants=3, random_state=0)
    >>> answers = simulate_answers(study, truth=walkers.target["happy"], random_state=0)
    >>> answers["value"].value_counts().sort_index().to_dict()
    {1.0: 68, 2.0: 114, 3.0: 163, 4.0: 188, 5.0: 124, 6.0: 63}
    >>> seen = ratings_to_traits(answers, walks=walkers.data)["happy"]
    >>> round(float(seen.corr(walkers.target["happy"])), 2)
    0.88
    """
    spreads = _Spreads(noise, taste, bias, gain)
    for name, value in spreads._asdict().items():
        check_number(value, name, at_least=0)
    for name, share in {"lapse": lapse, "missing": missing}.items():
        check_number(share, name, at_least=0, at_most=1)
    judges = _make_judges(study, truth)
    design = study.design[study.design["participant"].isin(_check_participants(study, participants))]
    design = design.reset_index(drop=True)
    seed = int(check_random_state(random_state).randint(2**31 - 1))
    shown, expected = (design[name].to_numpy(dtype=object) for name in ("stimulus", "expected"))
    parts = []
    for (participant, name, trait), rows in design.groupby(["participant", "task", "trait"]).indices.items():
        number = study.tasks.index(study.task_of(name, trait))
        random = np.random.default_rng((seed, int(participant), number))
        parts.append((rows, *_answer(judges[number], shown[rows], expected[rows], random, spreads, lapse, missing)))
    places, *columns = (np.concatenate(part) for part in zip(*parts, strict=True))
    given = pd.DataFrame(dict(zip(("answer", "value", "given"), columns, strict=True)), index=places)
    answers = pd.concat([design, simulate_timing(study, design, seed=seed), given], axis=1).assign(study=study.id)
    answers = answers.loc[answers["given"], list(ANSWER_COLUMNS)].reset_index(drop=True)
    return answers.astype({name: _TYPES[column.kind] for name, column in ANSWER_COLUMNS.items()})


class _Spreads(NamedTuple):
    """How much observers differ, in standard deviations."""

    noise: float
    taste: float
    bias: float
    gain: float


class _Judge(NamedTuple):
    """What all observers of a task share: its buttons, where stimuli are in the tables, and what is true of them."""

    answers: NDArray[np.object_]
    values: NDArray[np.float64]
    places: dict[str, int]
    traits: NDArray[np.float64] | None  # (n_stimuli,), of ratings
    limits: NDArray[np.float64]  # (n_answers - 1,) of ratings; else sums of chances, (n_stimuli, n_answers - 1)
    order: NDArray[np.intp]  # of the answers, from the worst to the best, (n_stimuli, n_answers)


def _check_participants(study: Study, participants: Sequence[int] | None) -> list[int]:
    known = set(study.design["participant"].tolist())
    if participants is None:
        return sorted(known)
    wanted = [int(participant) for participant in participants]
    foreign = sorted(set(wanted) - known)
    if foreign or not wanted:
        got = ", ".join(map(str, foreign[:10])) or "none"
        raise ValueError(f"participants must be among the {len(known)} of the design, got {got}")
    return wanted


def _make_judges(study: Study, truth: Any) -> list[_Judge]:
    """Return a judge for each task, or raise all that is wrong with the truth."""
    by_task, faults, judges = _by_task(truth, study), [], []
    for task in study.tasks:
        judged = [stimulus for stimulus in study.stimuli if stimulus.reference or not task.is_pair]
        try:
            judges.append(_make_judge(task, judged, by_task.get(task.name)))
        except ValueError as error:
            faults.append(str(error))
    if faults:
        raise ValueError("; ".join(dict.fromkeys(faults)))
    return judges


def _by_task(truth: Any, study: Study) -> Mapping[str, Any]:
    """Return the truth of each kind of task."""
    names = sorted({task.name for task in study.tasks})
    if truth is None:
        return {}
    if not (isinstance(truth, Mapping) and set(truth) & set(names)):
        if len(names) > 1:
            raise ValueError(
                "truth of a study with several kinds of tasks must be a mapping from their names, "
                f"{{{', '.join(f'{name!r}: ...' for name in names)}}}, got a {type(truth).__name__}"
            )
        truth = {names[0]: truth}
    foreign = sorted(str(name) for name in set(truth) - set(names))
    traits = [task.trait for task in study.tasks if isinstance(task, RatingTask)]
    rated = truth.get(RatingTask.name)
    if foreign:
        raise ValueError(f"truth: expected tasks of the study, {', '.join(names)}, got {', '.join(foreign)}")
    if len(traits) > 1 and not (rated is None or isinstance(rated, pd.DataFrame)):
        raise ValueError(
            f"truth of several rating tasks must be a DataFrame with the columns {', '.join(traits)}, got a "
            f"{type(rated).__name__}"
        )
    return truth


def _make_judge(task: Task, shown: list[Stimulus], truth: Any) -> _Judge:
    answers = np.array([button.answer for button in task.buttons], dtype=object)
    values = np.array([np.nan if button.value is None else button.value for button in task.buttons], np.float64)
    places = {stimulus.name: place for place, stimulus in enumerate(shown)}
    order = answer_order(task, shown)
    if isinstance(task, RatingTask):
        n = task.n_buttons
        cuts = _SCALE * (np.arange(1, n) / n - 0.5)
        return _Judge(answers, values, places, latent_traits(task, shown, truth), cuts, order)
    chances = np.take_along_axis(answer_chances(task, shown, truth).to_numpy(), order, axis=1)
    return _Judge(answers, values, places, None, np.cumsum(chances, axis=1)[:, :-1], order)


def _answer(
    judge: _Judge,
    names: NDArray[np.object_],
    expected: NDArray[np.object_],
    random: np.random.Generator,
    spreads: _Spreads,
    lapse: float,
    missing: float,
) -> tuple[NDArray[np.object_], NDArray[np.float64], NDArray[np.bool_]]:
    """Return answers and values of one observer in the trials of a task, and whether they were given."""
    pressed = _press(judge, names, random, spreads)
    button_of = {answer: button for button, answer in enumerate(judge.answers)}
    heeded = [button_of.get(asked, button) for asked, button in zip(expected, pressed, strict=True)]
    blind = random.integers(len(judge.answers), size=len(names))
    pressed = np.where(random.random(len(names)) < lapse, blind, heeded)
    return judge.answers[pressed], judge.values[pressed], random.random(len(names)) >= missing


def _press(
    judge: _Judge, names: NDArray[np.object_], random: np.random.Generator, spreads: _Spreads
) -> NDArray[np.intp]:
    """Return which button one observer would press in each trial."""
    places = np.array([judge.places[name] for name in names])
    bias, gain = random.standard_normal(2)
    opinions, passing = random.standard_normal(len(judge.places)), random.standard_normal(len(names))
    shifts = spreads.bias * bias + spreads.taste * opinions[places] + spreads.noise * passing
    if judge.traits is not None:
        return np.searchsorted(judge.limits, np.exp(spreads.gain * gain) * judge.traits[places] + shifts)
    spread = float(np.linalg.norm(spreads[:3]))
    shares = ndtr(shifts / spread if spread else shifts)[:, np.newaxis]
    return judge.order[places, (shares > judge.limits[places]).sum(axis=1)]
