"""Perception studies: what people, or classifiers, make of walks, from the task to the figures and back to a trait."""

from eigenwalker.experiment.answer_columns import ANSWER_COLUMNS, DESIGN_COLUMNS
from eigenwalker.experiment.design import cyclic_square, make_design
from eigenwalker.experiment.discrimination import Discrimination, discriminate_walks
from eigenwalker.experiment.rates import Estimated, rate_difference, rate_interval
from eigenwalker.experiment.recognition import (
    answer_shares,
    confusion_tables,
    rate_correlation,
    recognition_difference,
    recognition_table,
    style_rates,
)
from eigenwalker.experiment.resemblance import RESEMBLANCE, mean_resemblance, resemblance_table
from eigenwalker.experiment.showing import Showing
from eigenwalker.experiment.stimulus import Stimulus, cross_stimuli
from eigenwalker.experiment.study import Study, make_study
from eigenwalker.experiment.style_judge import JudgedFeatures, judge_styles, make_style_judge
from eigenwalker.experiment.tasks import (
    NaturalnessTask,
    PairTask,
    RatingTask,
    RecognitionTask,
    ResemblanceTask,
)
from eigenwalker.experiment.variability import cut_alike, stride_variability, variance_ratio

__all__ = [
    "ANSWER_COLUMNS",
    "DESIGN_COLUMNS",
    "RESEMBLANCE",
    "Discrimination",
    "Estimated",
    "JudgedFeatures",
    "NaturalnessTask",
    "PairTask",
    "RatingTask",
    "RecognitionTask",
    "ResemblanceTask",
    "Showing",
    "Stimulus",
    "Study",
    "answer_shares",
    "confusion_tables",
    "cross_stimuli",
    "cut_alike",
    "cyclic_square",
    "discriminate_walks",
    "judge_styles",
    "make_design",
    "make_study",
    "make_style_judge",
    "mean_resemblance",
    "rate_correlation",
    "rate_difference",
    "rate_interval",
    "recognition_difference",
    "recognition_table",
    "resemblance_table",
    "stride_variability",
    "style_rates",
    "variance_ratio",
]
