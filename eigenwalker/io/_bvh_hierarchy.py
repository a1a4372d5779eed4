"""The part of a BVH file before MOTION: a tree of joints with their offsets and channels."""

import re
from collections.abc import Iterator
from dataclasses import dataclass

from eigenwalker._validation import WalkError
from eigenwalker.io._text import decimal, listed, shown

__all__ = ["BvhJoint", "read_hierarchy"]

_CHANNELS = frozenset(axis + kind for axis in "XYZ" for kind in ("position", "rotation"))
_MOST_JOINTS = 5000  # a body with all fingers and a face has about 200


@dataclass(frozen=True)
class BvhJoint:
    """One joint as the file has it.

    Parameters
    ----------
    name : str
        Its name.
    parent : int
        Position of its parent, -1 for the ROOT.
    offset : tuple of float
        Its OFFSET.
    channels : tuple of str
        ``Xposition``, ``Zrotation`` and so on, in the order of the file.
    """

    name: str
    parent: int
    offset: tuple[float, ...]
    channels: tuple[str, ...]


@dataclass
class _Block:
    """A joint or an end site while it is being read."""

    title: str
    name: str
    line: int
    parent: int
    position: int  # among the joints; -1 for an end site
    offset: tuple[float, ...] | None = None
    channels: tuple[str, ...] | None = None


def read_hierarchy(lines: list[str]) -> tuple[list[BvhJoint], list[tuple[int, tuple[float, ...]]], int]:
    """Return the joints, the end sites (joint and offset), and the position of the line after MOTION."""
    statements = _statements(lines)
    number, first = next(statements, (1, ""))
    if first.upper() != "HIERARCHY":
        raise WalkError(f"line {number}: expected HIERARCHY, with which BVH files start, got {shown(first)}")
    tree = _Tree()
    for number, statement in statements:
        keyword, *rest = statement.split(maxsplit=1)
        tree.read(number, keyword, rest[0] if rest else "")
        if tree.whole:
            ends = [(end.parent, end.offset or ()) for end in tree.ends]
            return [_joint(block) for block in tree.joints], ends, number
    still = f" with {tree.open[-1].title} of line {tree.open[-1].line} still open" if tree.open else ""
    raise WalkError(
        f"line {len(lines)}: expected MOTION after the joints, got the end of the file{still}; "
        "the file seems to be cut off; get it again"
    )


def _statements(lines: list[str]) -> Iterator[tuple[int, str]]:
    """Yield each line's number and text, with braces on their own."""
    for number, line in enumerate(lines, 1):
        for part in re.split(r"([{}])", line):
            if part.strip():
                yield number, part.strip()


def _joint(block: _Block) -> BvhJoint:
    return BvhJoint(block.name, block.parent, block.offset or (), block.channels or ())


class _Tree:
    """The joints read so far and the blocks that are still open."""

    def __init__(self) -> None:
        self.joints: list[_Block] = []
        self.by_name: dict[str, _Block] = {}
        self.ends: list[_Block] = []
        self.open: list[_Block] = []
        self.named: _Block | None = None  # a block whose brace is still to come
        self.whole = False

    def read(self, line: int, keyword: str, rest: str) -> None:
        """Take in one statement."""
        actions = {
            "ROOT": self._root,
            "JOINT": self._joint,
            "END": self._end,
            "{": self._enter,
            "}": self._leave,
            "OFFSET": self._offset,
            "CHANNELS": self._channels,
            "MOTION": self._motion,
        }
        if self.named is not None and keyword != "{":
            raise WalkError(f"line {line}: expected '{{' after {self.named.title}, got {shown(keyword + ' ' + rest)}")
        if keyword.upper() not in actions:
            raise WalkError(f"line {line}: expected one of {', '.join(actions)}, got {shown(keyword)}")
        actions[keyword.upper()](line, rest)

    def _root(self, line: int, rest: str) -> None:
        if self.open:
            raise WalkError(f"line {line}: expected JOINT within {self.open[-1].title}, got ROOT {shown(rest)}")
        self._name_joint("ROOT", line, rest)

    def _joint(self, line: int, rest: str) -> None:
        self._parent(line, "JOINT")
        self._name_joint("JOINT", line, rest)

    def _name_joint(self, keyword: str, line: int, name: str) -> None:
        if not name:
            raise WalkError(f"line {line}: expected a name after {keyword}, got none")
        if len(self.joints) == _MOST_JOINTS:
            raise WalkError(f"line {line}: expected at most {_MOST_JOINTS} joints of a body, got more")
        first = self.by_name.get(name)
        if first is not None:
            raise WalkError(f"line {line}: expected a new name, got {shown(name)} again, as in line {first.line}")
        parent = self.open[-1].position if self.open else -1
        self.named = self.by_name[name] = _Block(f"{keyword} {shown(name)}", name, line, parent, len(self.joints))
        self.joints.append(self.named)

    def _end(self, line: int, rest: str) -> None:
        parent = self._parent(line, "End Site")
        self.named = _Block("End Site", "", line, parent.position, -1)
        self.ends.append(self.named)

    def _enter(self, line: int, rest: str) -> None:
        if self.named is None:
            raise WalkError(f"line {line}: expected a ROOT, JOINT or End Site before '{{', got none")
        self.open.append(self.named)
        self.named = None

    def _leave(self, line: int, rest: str) -> None:
        if not self.open:
            raise WalkError(f"line {line}: expected no '}}' here, as all blocks are closed; the braces do not balance")
        block = self.open.pop()
        if block.offset is None:
            raise WalkError(f"line {line}: expected an OFFSET in {block.title} of line {block.line}, got none")

    def _offset(self, line: int, rest: str) -> None:
        block = self._current(line, "OFFSET")
        numbers = [decimal(word) for word in rest.split()]
        if block.offset is not None or len(numbers) != 3 or None in numbers:
            raise WalkError(f"line {line}: expected one OFFSET with three finite numbers a joint, got {shown(rest)}")
        block.offset = tuple(number for number in numbers if number is not None)

    def _channels(self, line: int, rest: str) -> None:
        block = self._parent(line, "CHANNELS")
        if block.channels is not None:
            raise WalkError(f"line {line}: expected one line of CHANNELS in {block.title}, got a second one")
        block.channels = _channel_names(line, rest)

    def _motion(self, line: int, rest: str) -> None:
        """Check that the tree is whole."""
        if self.open:
            raise WalkError(
                f"line {line}: expected '}}' for {self.open[-1].title} of line {self.open[-1].line}, got MOTION; "
                "the braces do not balance"
            )
        roots = [f"{block.name!r} (line {block.line})" for block in self.joints if block.parent < 0]
        if len(roots) != 1:
            raise WalkError(
                f"line {line}: expected one ROOT before MOTION, got {len(roots)}: {listed(roots) or 'none'}; "
                "split a file of several bodies into one file a body"
            )
        self.whole = True

    def _current(self, line: int, keyword: str) -> _Block:
        if not self.open:
            raise WalkError(f"line {line}: expected {keyword} within the braces of a joint, got it outside")
        return self.open[-1]

    def _parent(self, line: int, keyword: str) -> _Block:
        block = self._current(line, keyword)
        if block.position < 0:
            raise WalkError(
                f"line {line}: expected {keyword} within a joint, got it in the End Site of line {block.line}"
            )
        return block


def _channel_names(line: int, rest: str) -> tuple[str, ...]:
    """Return the names after CHANNELS, spelled as in `_CHANNELS`."""
    count, *words = rest.split() or [""]
    if re.fullmatch("[0-6]", count) is None or len(words) != int(count):
        raise WalkError(f"line {line}: expected CHANNELS, a number from 0 to 6 and as many names, got {shown(rest)}")
    names = tuple(word.capitalize() for word in words)
    unknown = [word for word, name in zip(words, names, strict=True) if name not in _CHANNELS]
    if unknown:
        raise WalkError(f"line {line}: expected channels among {', '.join(sorted(_CHANNELS))}, got {shown(unknown[0])}")
    positions = [name for name in names if name.endswith("position")]
    if len(set(positions)) < len(positions):
        raise WalkError(f"line {line}: expected each position channel once, got {shown(' '.join(words))}")
    return names
