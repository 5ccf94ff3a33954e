"""What is said of command lines that are nearly right: what may have been meant."""

import pytest

from coilset.scripts.main import app
from coilset.scripts.running import command_line_message

NEARLY = [
    (["solv", "case.yaml"], "No such command 'solv'. Is solve meant?"),
    (["materials"], "No such command 'materials'. Is material meant?"),
    (["xyz"], "No such command 'xyz'. coilset --help lists the commands."),
    (["solve", "-n", "2", "case.yaml"], "-n goes before the command, as in coilset -n 2 solve"),
]


@pytest.mark.parametrize(("value", "message"), [("x", "'x' is not a valid integer"), ("0", "0 is not in the range")])
def test_a_wrong_value_of_the_environment_is_called_by_its_variable(monkeypatch, value, message):
    monkeypatch.setenv("COILSET_THREADS", value)
    for words, place in (
        (["solve", "case.yaml"], " of COILSET_THREADS"),
        (["solve", "case.yaml", "--threads", value], " for '--threads'"),
    ):
        with pytest.raises(Exception) as caught:
            app(words, prog_name="coilset", standalone_mode=False)
        assert command_line_message(caught.value).startswith(f"Invalid value{place}: {message}")


@pytest.mark.parametrize(("words", "message"), NEARLY)
def test_what_may_have_been_meant_is_said(words, message):
    with pytest.raises(Exception) as caught:  # of click, under whatever name typer has it
        app(words, prog_name="coilset", standalone_mode=False)
    said = command_line_message(caught.value)
    assert message in said
    assert "\n" not in said
