"""Files of answers: read, checked, and written as a data set.

It imports no other room.
"""
