"""The skeleton of an ASF file: bones in a rest posture, each with the frame that its angles are about.

Errors start with ``line 12:``; the reader puts the file's name before them.
"""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from eigenwalker._validation import WalkError
from eigenwalker.io._text import decimal, decode_lines, shown

__all__ = ["LARGEST", "AsfBone", "AsfSkeleton", "Statement", "parse_asf", "statements"]

LARGEST = 1e9  # no length or angle is beyond
_MOST_BONES = 500  # a body with all fingers has about 70
_TURNS = ("rx", "ry", "rz")
_MOVES = ("tx", "ty", "tz")


class Statement(NamedTuple):
    """One line of a file: its number and its words, without comment and brackets."""

    line: int
    words: list[str]


@dataclass(frozen=True, eq=False)
class AsfBone:
    """One bone as the file has it.

    Parameters
    ----------
    name : str
        Its name.
    parent : int
        Position of the bone at whose end it starts; 0 is the root and 1 the first bone.
    tip : ndarray of shape (3,)
        From its start to its end, direction times length, in the rest posture.
    frame : ndarray of shape (3, 3)
        Rotation matrix from its local axes to those of the file.
    dof : tuple of str
        The values an AMC file gives it, such as ``("rx", "rz")``; the first one turns first, about fixed axes.
    """

    name: str
    parent: int
    tip: NDArray[np.float64]
    frame: NDArray[np.float64]
    dof: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class AsfSkeleton:
    """What an ASF file says, in its own units and axes.

    Parameters
    ----------
    bones : list of AsfBone
        Parents before children, without the root.
    root_dof : tuple of str
        The values an AMC file gives the root, such as ``("tx", "ty", "tz", "rx", "ry", "rz")``.
    root_position : ndarray of shape (3,)
        Where the root is before they are added.
    length : float
        The number that inches were multiplied with.
    degrees : bool
        Whether angles are in degrees.
    """

    bones: list[AsfBone]
    root_dof: tuple[str, ...]
    root_position: NDArray[np.float64]
    length: float
    degrees: bool


@dataclass(frozen=True)
class _Block:
    """A bone between begin and end: the line of begin, and the statements by their first word."""

    line: int
    name: str
    entries: dict[str, Statement]


def statements(lines: Iterable[str]) -> Iterator[Statement]:
    """Yield the lines with text. Commas and brackets are white space, and ``#`` starts a comment."""
    text = "\n".join(lines).translate(str.maketrans(",()", "   "))
    for number, line in enumerate(text.split("\n"), 1):
        words = (line.partition("#")[0] if "#" in line else line).split()
        if words:
            yield Statement(number, words)


def parse_asf(data: bytes) -> AsfSkeleton:
    """Return what the bytes of an ASF file say, or raise a WalkError that names the line."""
    lines = decode_lines(data, "an ASF file")
    sections = _sections(lines)
    missing = [name for name in (":root", ":bonedata", ":hierarchy") if name not in sections]
    if missing:
        raise WalkError(f"line {len(lines)}: expected the section {missing[0]}, got the end of the file without it")
    length, degrees = _units(sections.get(":units", []))
    root_dof, root_position = _root(sections[":root"])
    blocks = _blocks(sections[":bonedata"])
    parents = _parents(sections[":hierarchy"], blocks)
    order = _parents_first(parents, sections[":hierarchy"][-1].line)
    bones = [_bone(blocks[name], order.index(parents[name]), degrees) for name in order[1:]]
    return AsfSkeleton(bones, root_dof, root_position, length, degrees)


def _sections(lines: list[str]) -> dict[str, list[Statement]]:
    """Return the statements of each section, the first one with what follows its keyword."""
    sections: dict[str, list[Statement]] = {}
    current: list[Statement] | None = None
    for statement in statements(lines):
        if statement.words[0].startswith(":"):
            keyword = statement.words[0].lower()
            if keyword in sections:
                raise WalkError(f"line {statement.line}: expected one section {keyword}, got a second one")
            current = sections[keyword] = [Statement(statement.line, statement.words[1:])]
        elif current is None:
            got = shown(" ".join(statement.words))
            raise WalkError(f"line {statement.line}: expected a section of an ASF file, such as :units, got {got}")
        else:
            current.append(statement)
    return sections


def _units(section: list[Statement]) -> tuple[float, bool]:
    """Return the factor of lengths and whether angles are in degrees."""
    entries = {entry.words[0].lower(): entry for entry in section if entry.words}
    length, degrees = 1.0, True
    if "length" in entries:
        (length,) = _numbers(entries["length"], 1)
        if not 1e-6 <= length <= 1e6:
            raise WalkError(f"line {entries['length'].line}: expected a positive length unit, got {length!r}")
    if "angle" in entries:
        word = " ".join(entries["angle"].words[1:]).lower()
        if word not in ("deg", "rad"):
            raise WalkError(f"line {entries['angle'].line}: expected angle deg or rad, got {shown(word)}")
        degrees = word == "deg"
    return length, degrees


def _root(section: list[Statement]) -> tuple[tuple[str, ...], NDArray[np.float64]]:
    """Return the values that AMC files give the root, and its position before them."""
    entries = {entry.words[0].lower(): entry for entry in section if entry.words}
    if "order" not in entries:
        raise WalkError(f"line {section[0].line}: expected 'order TX TY TZ RX RY RZ' in :root, got none")
    dof = _names_of_dof(entries["order"], (*_MOVES, *_TURNS))
    position = _numbers(entries["position"], 3) if "position" in entries else [0.0] * 3
    if "orientation" in entries and any(_numbers(entries["orientation"], 3)):
        raise WalkError(
            f"line {entries['orientation'].line}: expected orientation 0 0 0, because programs do not agree on what "
            "else it turns; write the file without it, and turn the walk after reading"
        )
    return dof, np.array(position)


def _blocks(section: list[Statement]) -> dict[str, _Block]:
    """Return the bones by name, as they stand between begin and end."""
    blocks: dict[str, _Block] = {}
    begin = 0
    entries: dict[str, Statement] = {}
    for entry in section[1:]:
        word = entry.words[0].lower()
        if (word == "begin") == (begin > 0) and word in ("begin", "end"):
            raise WalkError(f"line {entry.line}: expected begin and end around each bone by turns, got {word!r}")
        if word == "begin":
            begin, entries = entry.line, {}
        elif word == "end":
            block = _block(begin, entries)
            if block.name in blocks or block.name == "root":
                raise WalkError(f"line {begin}: expected a new name, got a second bone {shown(block.name)}")
            blocks[block.name] = block
            begin = 0
        elif begin:
            entries[word] = entry
    if begin:
        raise WalkError(f"line {begin}: expected an end of the bone that begins here; the file seems to be cut off")
    if len(blocks) > _MOST_BONES:
        raise WalkError(f"line {section[0].line}: expected at most {_MOST_BONES} bones of a body, got {len(blocks)}")
    return blocks


def _block(begin: int, entries: dict[str, Statement]) -> _Block:
    missing = [key for key in ("name", "direction", "length", "axis") if key not in entries]
    if missing:
        raise WalkError(f"line {begin}: expected name, direction, length and axis of a bone, got no {missing[0]}")
    name = entries["name"]
    if len(name.words) != 2:
        raise WalkError(f"line {name.line}: expected one word as the name, got {shown(' '.join(name.words[1:]))}")
    return _Block(begin, name.words[1], entries)


def _parents(section: list[Statement], blocks: dict[str, _Block]) -> dict[str, str]:
    """Return the name of each bone's parent."""
    parents: dict[str, str] = {}
    for entry in section[1:]:
        parent, *children = entry.words
        if not children and parent.lower() in ("begin", "end"):
            continue
        unknown = [name for name in entry.words if name not in blocks and name != "root"]
        if unknown or "root" in children:
            wrong = (unknown or ["root"])[0]
            raise WalkError(f"line {entry.line}: expected a bone and its children from :bonedata, got {shown(wrong)}")
        for child in children:
            if child in parents:
                raise WalkError(f"line {entry.line}: expected one parent for each bone, got a second for {child!r}")
            parents[child] = parent
    return parents | {name: "" for name in blocks if name not in parents}


def _parents_first(parents: dict[str, str], line: int) -> list[str]:
    """Return the names, root first, each bone with all that hangs from it before its next sibling."""
    children: dict[str, list[str]] = {}
    for name, parent in parents.items():
        children.setdefault(parent, []).append(name)
    order, waiting = [], ["root"]
    while waiting:
        order.append(waiting.pop())
        waiting.extend(reversed(children.get(order[-1], [])))
    apart = sorted(set(parents) - set(order))
    if apart:
        raise WalkError(f"line {line}: expected all bones to hang from the root in :hierarchy, but not {apart[0]!r}")
    return order


def _bone(block: _Block, parent: int, degrees: bool) -> AsfBone:
    direction = np.array(_numbers(block.entries["direction"], 3))
    (length,) = _numbers(block.entries["length"], 1)
    axis = block.entries["axis"]
    turn = _numbers(Statement(axis.line, axis.words[:4]), 3)
    order = "".join(axis.words[4:]).lower()
    if sorted(order) != ["x", "y", "z"]:
        raise WalkError(f"line {axis.line}: expected three angles and an order such as XYZ, got {shown(order)}")
    frame = Rotation.from_euler(order, turn, degrees=degrees).as_matrix()  # small letters: about fixed axes
    dof = _names_of_dof(block.entries["dof"], _TURNS) if "dof" in block.entries else ()
    return AsfBone(block.name, parent, length * direction, frame, dof)


def _names_of_dof(entry: Statement, known: tuple[str, ...]) -> tuple[str, ...]:
    names = tuple(word.lower() for word in entry.words[1:])
    if set(names) - set(known) or len(set(names)) < len(names):
        got = shown(" ".join(names))
        raise WalkError(f"line {entry.line}: expected {entry.words[0]} with each of {', '.join(known)} once, got {got}")
    return names


def _numbers(entry: Statement, count: int) -> list[float]:
    """Return the numbers after the first word."""
    numbers = [decimal(word) for word in entry.words[1:]]
    sound = [number for number in numbers if number is not None and math.fabs(number) <= LARGEST]
    if len(sound) != len(numbers) or len(sound) != count:
        got = shown(" ".join(entry.words[1:]))
        raise WalkError(f"line {entry.line}: expected {entry.words[0]} with {count} finite numbers, got {got}")
    return sound
