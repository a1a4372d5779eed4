"""What the tests of the command line share."""

import pytest

from eigenwalker.cli import main


@pytest.fixture
def run(capsys):
    """Run the command and return its exit status and what it printed."""

    def call(*arguments):
        status = main([str(argument) for argument in arguments])
        printed = capsys.readouterr()
        return status, printed.out, printed.err

    return call
