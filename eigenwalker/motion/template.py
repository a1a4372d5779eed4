"""What walks have in common with one another: one frame of the first one, which the others are checked against."""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eigenwalker._validation import WalkError
from eigenwalker.motion.walk import AnyWalk, JointWalk, Walk

__all__ = ["check_alike", "fill_template", "one_frame"]


def one_frame(walk: AnyWalk) -> AnyWalk:
    """Keep the kind and the channels of a walk, and one frame, without what is its own."""
    plain: dict[str, Any] = {"name": "", "speed": math.nan, "size": 1.0, "events": (), "frequency": math.nan}
    if isinstance(walk, JointWalk):
        still = {joint: path[:1] for joint, path in walk.translations.items()}
        return replace(walk, rotations=walk.rotations[:1], root=walk.root[:1], translations=still, **plain)
    return replace(walk, positions=walk.positions[:1], **plain)


def fill_template(template: AnyWalk, channels: NDArray[np.float64], **fields: Any) -> AnyWalk:
    """Return a walk with channels, shape (n_frames, n_channels), and other fields; its root stays where it was."""
    if isinstance(template, JointWalk):
        fields["root"] = np.repeat(template.root, len(channels), axis=0)
        fields["translations"] = {
            joint: np.repeat(path, len(channels), axis=0) for joint, path in template.translations.items()
        }
    return template.with_channels(channels, **fields)


def check_alike(walks: Sequence[Walk | JointWalk], template: Walk | JointWalk) -> None:
    """Raise a WalkError if a walk has other channels than the template, or joints along other axes."""
    expected = template.channel_names
    for walk in walks:
        if walk.channel_names != expected:
            lacks = [name for name in expected if name not in walk.channel_names]
            adds = [name for name in walk.channel_names if name not in expected]
            raise WalkError(
                f"walk {walk.name!r}: expected the {len(expected)} channels of the first walk in fit, got "
                f"{len(walk.channel_names)}; missing: {', '.join(lacks[:6]) or 'none'}; unknown: "
                f"{', '.join(adds[:6]) or 'none'}; bring all walks to one "
                + (
                    "skeleton, and prepare them with the same joints=..."
                    if isinstance(walk, JointWalk)
                    else "marker set, in one order"
                )
            )
        if _is_upright(walk) != _is_upright(template):
            raise WalkError(
                f"walk {walk.name!r}: expected rotations along the axes of the room in all walks or in none; "
                "prepare all of them with representation='joints'"
            )


def _is_upright(walk: Walk | JointWalk) -> bool:
    return isinstance(walk, JointWalk) and walk.skeleton.upright
