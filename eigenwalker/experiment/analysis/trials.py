"""Answers of people as trials, the form in which answers of people and of classifiers are analyzed alike."""

from typing import NamedTuple

import pandas as pd

from eigenwalker._validation import check_choice
from eigenwalker.experiment.stimulus import AVERAGE
from eigenwalker.experiment.tasks import TASKS

__all__ = ["TaskTrials", "split_trials", "trials_of"]

_NEEDED = ("task", "answer", "style", "kind")
_KEPT = ("truth", "answer", "kind", "walk", "stimulus", "condition", "participant")
_ONCE = ["participant", "session", "trial"]


class TaskTrials(NamedTuple):
    """The answers to one task, and what was left out.

    Parameters
    ----------
    table : DataFrame
        One row an answer of the main part: truth, the style; answer; kind; and, where the answers have them, stimulus,
        its name, condition, participant, and walk, see `trials_of`.
    n_unanswered : int
        Rows of the main part without an answer, which are left out.
    attention : DataFrame
        One row a participant with attention trials: n_trials, those that were answered, and n_failed, those that were
        answered otherwise than they asked for. Nobody is left out for them.
    """

    table: pd.DataFrame
    n_unanswered: int
    attention: pd.DataFrame

    def in_words(self) -> str:
        """Return how many answers there are, of whom, about what, what is missing and who was not attentive."""
        counts = [_count(len(self.table), "answer")]
        for column, before, word in (("participant", "of", "participant"), ("stimulus", "about", "walk")):
            if column in self.table:
                counts.append(f"{before} {_count(self.table[column].nunique(), word)}")
        missing = f", {_count(self.n_unanswered, 'trial')} without an answer" if self.n_unanswered else ""
        return f"{' '.join(counts)}{missing}.{self._attention_in_words()}"

    def _attention_in_words(self) -> str:
        if not len(self.attention):
            return ""
        failed = self.attention[self.attention["n_failed"] > 0]
        who = [f"{name} ({row.n_failed} of {row.n_trials})" for name, row in failed.iterrows()]
        none = f"none of {self.attention['n_trials'].sum()}"
        return f" Attention trials failed: {'by participant ' + ', '.join(who) if who else none}."


def trials_of(answers: pd.DataFrame, task: str) -> TaskTrials:
    """Return the answers to one task as trials: those of the main part that were given.

    Their column walk tells which answers are about the same movement. Where each style has one walk of each kind and
    under each condition, as in Tilmanne, Moinet & Dutoit 2012, 6.1, it is the style: these are one recording, with and
    without its way over the floor, and its synthesis, and a style that is hard to recognize in one is so in all. Else
    it is the name of the stimulus.

    Parameters
    ----------
    answers : DataFrame
        With the columns task, answer, style and kind, and as many of study, participant, session, trial, part,
        stimulus, condition and expected as there are: see `ANSWER_COLUMNS`. Without `part` all are of the main part.
        Participants of several studies are told apart by study and number.
    task : {"rating", "pair", "naturalness", "recognition", "resemblance"}
        Which one.

    Returns
    -------
    TaskTrials

    Raises
    ------
    TypeError
        If the answers are no DataFrame.
    ValueError
        If columns are missing, a trial of a participant was answered twice, there is no answer to the task, or the task
        is an unknown one.

    Examples
    --------
    >>> answers = pd.DataFrame(
    ...     {
    ...         "participant": 1,
    ...         "task": "recognition",
    ...         "part": ["practice", "main", "main"],
    ...         "style": ["sad", "sad", "cool"],
    ...         "kind": "original",
    ...         "answer": ["cool", "sad", ""],
    ...     }
    ... )
    >>> trials = trials_of(answers, "recognition")
    >>> trials.table
      truth answer      kind  participant
    0   sad    sad  original            1
    >>> trials.in_words()
    '1 answer of 1 participant, 1 trial without an answer.'
    """
    check_choice(task, tuple(TASKS), name="task")
    asked = _of_task(answers, task)
    part = asked["part"] if "part" in asked else pd.Series("main", index=asked.index)
    given = asked["answer"].notna() & (asked["answer"].astype(str) != "")
    main = part == "main"
    if not (main & given).any():
        raise ValueError(f"expected answers to the task {task!r}, got none in its main part")
    table = asked[main & given].rename(columns={"style": "truth"}).astype({"answer": str})
    if "stimulus" in table:
        table["walk"] = table["truth" if _one_walk_a_style(asked[main]) else "stimulus"]
    table = table[[name for name in _KEPT if name in table]].reset_index(drop=True)
    return TaskTrials(table, int((main & ~given).sum()), _attention(asked[(part == "attention") & given]))


def split_trials(trials: pd.DataFrame) -> dict[tuple[str, str], pd.DataFrame]:
    """Return trials of all walks, of each condition and of each style, as reports have them.

    Parameters
    ----------
    trials : DataFrame
        With the column truth, and maybe condition, participant and walk.

    Returns
    -------
    dict of (str, str) to DataFrame
        ("all", "all walks"), ("condition", "static") and so on, in the order of names, the average walk last. Trials of
        a style have no column walk: a style has a walk or two, which are no sample of others, so what is said of it is
        about them. Trials without a style are in none.
    """
    parts = {("all", "all walks"): trials}
    if "condition" in trials:
        known = trials[trials["condition"].fillna("").astype(str) != ""]
        parts |= {("condition", str(name)): part for name, part in known.groupby("condition")}
    alone = trials[trials["truth"].astype(str) != ""].drop(columns="walk", errors="ignore")
    styles = {("style", str(name)): part for name, part in alone.groupby("truth")}
    return parts | dict(sorted(styles.items(), key=lambda item: item[0][1] == AVERAGE))


def _of_task(answers: pd.DataFrame, task: str) -> pd.DataFrame:
    if not isinstance(answers, pd.DataFrame):
        raise TypeError(f"expected answers as a DataFrame, got {type(answers).__name__}")
    lacking = [name for name in _NEEDED if name not in answers.columns]
    if lacking:
        raise ValueError(f"expected the columns {', '.join(_NEEDED)}, missing: {', '.join(lacking)}")
    asked = answers[answers["task"] == task]
    if "study" in asked and "participant" in asked and asked["study"].nunique() > 1:
        asked = asked.assign(participant=asked["study"].astype(str) + " " + asked["participant"].astype(str))
    if set(_ONCE) <= set(asked.columns):
        twice = asked[asked.duplicated(_ONCE)]
        if len(twice):
            named = ", ".join(f"{name} {value}" for name, value in twice.iloc[0][_ONCE].items())
            raise ValueError(f"expected one row a trial, got {len(twice)} more, first {named}; drop those that repeat")
    return asked


def _one_walk_a_style(asked: pd.DataFrame) -> bool:
    shown = [name for name in ("style", "kind", "condition") if name in asked]
    return bool(
        (asked["style"].astype(str) != "").all() and asked.groupby(shown, dropna=False)["stimulus"].nunique().max() == 1
    )


def _attention(asked: pd.DataFrame) -> pd.DataFrame:
    if not {"expected", "participant"} <= set(asked.columns):
        return pd.DataFrame({"n_trials": [], "n_failed": []}, dtype=int).rename_axis("participant")
    failed = asked["answer"].astype(str) != asked["expected"].astype(str)
    return failed.groupby(asked["participant"]).agg(n_trials="count", n_failed="sum").astype(int)


def _count(number: int, word: str) -> str:
    return f"{number} {word}" if number == 1 else f"{number} {word}s"
