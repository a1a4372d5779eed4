"""Classifiers and measures in place of people.

Of the other rooms it imports `analysis`.
"""
