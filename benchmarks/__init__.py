"""Measurements against named peers: ``python -m benchmarks`` for all of them, ``python -m benchmarks.read`` for one.

Each benchmark is a module with a function ``findings(*, short)``, which prints tables in full and returns what it found
as plain data, rows beside a peer and checks; what a ratio is asked to reach and how large an error may be stands in a
constant at its top, and nowhere else. ``--short`` is a quick run of the same. The peers that are not dependencies come
with ``pip install ".[bench]"``; one that does not import is a row with the reason. ``python -m pytest benchmarks``
compares results with theirs.
"""
