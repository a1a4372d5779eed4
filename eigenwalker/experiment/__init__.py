"""Perception studies: what people, or classifiers, make of walks, from the task to the figures and back to a trait.

The modules beside this file are what a study is, and what all rooms need; they import none of the rooms:

- `running`: from a study to something that runs;
- `answers`: files of answers, read and written;
- `simulated`: answers before anybody was asked;
- `analysis`: what answers say, and reports of the tests;
- `ratings`: what ratings say of walkers, and how far observers agree;
- `judging`: classifiers and measures in place of people.

Imports between rooms point one way: `answers` < `running`; `analysis` < `ratings`, `judging`.
"""

from eigenwalker.experiment.analysis.crossed import crossed_difference, crossed_interval, crossed_mean, crossed_rate
from eigenwalker.experiment.analysis.means import mean_interval
from eigenwalker.experiment.analysis.naturalness_answers import NaturalnessReport, naturalness_report
from eigenwalker.experiment.analysis.rates import Estimated, rate_difference, rate_interval
from eigenwalker.experiment.analysis.recognition import (
    answer_shares,
    confusion_tables,
    rate_correlation,
    recognition_difference,
    recognition_table,
    style_rates,
)
from eigenwalker.experiment.analysis.recognition_answers import RecognitionReport, recognition_report
from eigenwalker.experiment.analysis.score_answers import ScoreReport, mean_resemblance, pair_report, resemblance_report
from eigenwalker.experiment.analysis.trials import TaskTrials, trials_of
from eigenwalker.experiment.answer_columns import ANSWER_COLUMNS, DESIGN_COLUMNS
from eigenwalker.experiment.answers.files import read_answers, write_answers
from eigenwalker.experiment.answers.psych_ds import check_dataset
from eigenwalker.experiment.design import cyclic_square, make_design
from eigenwalker.experiment.judging.discrimination import Discrimination, discriminate_walks
from eigenwalker.experiment.judging.resemblance import resemblance_table
from eigenwalker.experiment.judging.style_judge import JudgedFeatures, judge_styles, make_style_judge
from eigenwalker.experiment.judging.variability import cut_alike, stride_variability, variance_ratio
from eigenwalker.experiment.ratings.intervals import MeanRatings, mean_ratings
from eigenwalker.experiment.ratings.intraclass import (
    ICC_INTERVALS,
    ICC_KINDS,
    IntraclassCorrelation,
    intraclass_correlation,
)
from eigenwalker.experiment.ratings.reliability import reliability_table, view_correlations
from eigenwalker.experiment.ratings.split_half import split_half_reliability
from eigenwalker.experiment.ratings.traits import rating_counts, ratings_to_traits
from eigenwalker.experiment.running.study_files import build_study, read_study
from eigenwalker.experiment.showing import Showing
from eigenwalker.experiment.simulated.observers import simulate_answers
from eigenwalker.experiment.simulated.studies import simulate_studies
from eigenwalker.experiment.stimulus import Stimulus, cross_stimuli
from eigenwalker.experiment.study import Study, make_study
from eigenwalker.experiment.tasks import (
    RESEMBLANCE,
    NaturalnessTask,
    PairTask,
    RatingTask,
    RecognitionTask,
    ResemblanceTask,
)

__all__ = [
    "ANSWER_COLUMNS",
    "DESIGN_COLUMNS",
    "ICC_INTERVALS",
    "ICC_KINDS",
    "RESEMBLANCE",
    "Discrimination",
    "Estimated",
    "IntraclassCorrelation",
    "JudgedFeatures",
    "MeanRatings",
    "NaturalnessReport",
    "NaturalnessTask",
    "PairTask",
    "RatingTask",
    "RecognitionReport",
    "RecognitionTask",
    "ResemblanceTask",
    "ScoreReport",
    "Showing",
    "Stimulus",
    "Study",
    "TaskTrials",
    "answer_shares",
    "build_study",
    "check_dataset",
    "confusion_tables",
    "cross_stimuli",
    "crossed_difference",
    "crossed_interval",
    "crossed_mean",
    "crossed_rate",
    "cut_alike",
    "cyclic_square",
    "discriminate_walks",
    "intraclass_correlation",
    "judge_styles",
    "make_design",
    "make_study",
    "make_style_judge",
    "mean_interval",
    "mean_ratings",
    "mean_resemblance",
    "naturalness_report",
    "pair_report",
    "rate_correlation",
    "rate_difference",
    "rate_interval",
    "rating_counts",
    "ratings_to_traits",
    "read_answers",
    "read_study",
    "recognition_difference",
    "recognition_report",
    "recognition_table",
    "reliability_table",
    "resemblance_report",
    "resemblance_table",
    "simulate_answers",
    "simulate_studies",
    "split_half_reliability",
    "stride_variability",
    "style_rates",
    "trials_of",
    "variance_ratio",
    "view_correlations",
    "write_answers",
]
