"""What people or classifiers make of walks: recognition, naturalness and resemblance, analyzed alike."""

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
from eigenwalker.experiment.style_judge import JudgedFeatures, judge_styles, make_style_judge
from eigenwalker.experiment.variability import cut_alike, stride_variability, variance_ratio

__all__ = [
    "RESEMBLANCE",
    "Discrimination",
    "Estimated",
    "JudgedFeatures",
    "answer_shares",
    "confusion_tables",
    "cut_alike",
    "discriminate_walks",
    "judge_styles",
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
