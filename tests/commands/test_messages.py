"""What is said of command lines that are nearly right: what may have been meant."""

import pytest

from coilset.scripts.main import app, command_line_message

NEARLY = [
    (["solv", "case.yaml"], "No such command 'solv'. Is solve meant?"),
    (["materials"], "No such command 'materials'. Is material meant?"),
    (["xyz"], "No such command 'xyz'. coilset --help lists the commands."),
    (["solve", "-n", "2", "case.yaml"], "-n goes before the command, as in coilset -n 2 solve"),
]


@pytest.mark.parametrize(("words", "message"), NEARLY)
def test_what_may_have_been_meant_is_said(words, message):
    with pytest.raises(Exception) as caught:  # of click, under whatever name typer has it
        app(words, prog_name="coilset", standalone_mode=False)
    said = command_line_message(caught.value)
    assert message in said
    assert "\n" not in said
