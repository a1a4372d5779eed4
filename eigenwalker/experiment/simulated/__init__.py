"""Answers before anybody was asked: of observers that are not people.

It imports no other room.
"""
