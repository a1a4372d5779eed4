"""What answers say, whoever gave them: rates and means with intervals, and reports of the tests.

It imports no other room: answers come as tables.
"""
