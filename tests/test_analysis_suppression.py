"""Comments that say a finding is known."""

from __future__ import annotations

from pathlib import Path

import pytest

import ltlc
from ltlc.analysis.analyse import analyse
from ltlc.analysis.examine import examine
from ltlc.automata import Budget
from ltlc.base.diagnostics import Severity
from ltlc.base.source import Source
from ltlc.cli import main
from ltlc.frontend.language import load_text
from ltlc.frontend.language.suppression import suppress
from ltlc.semantics.encodings import EPISODE

EXACT = "eventually robot.velocity == 0"


def found(text: str) -> list[str]:
    """The names of what is left to be said about `text`."""
    specification, diagnostics = load_text(Source("props.txt", text))
    assert specification is not None
    report = analyse(specification, EPISODE, Budget(60.0, 1024))
    return [d.name for d in suppress(specification, [*diagnostics, *report.diagnostics])]


@pytest.mark.parametrize(
    "text",
    [
        f"{EXACT}  # ltlc: ignore LTL520",
        f"{EXACT}  #ltlc:ignore exact-equality because it is a test",
        f"# ltlc: ignore LTL520\n{EXACT}",
        f"# ltlc: ignore LTL520\n\n# more to say\n{EXACT}",
        f"# ltlc: ignore-file LTL520\nnever robot.velocity > 1\n{EXACT}",
        f"never robot.velocity > 1\n{EXACT}\n# ltlc: ignore-file exact-equality",
        "# ltlc: ignore LTL520\nstill: eventually\n  robot.velocity\n    == 0",
        "still: eventually\n  robot.velocity == 0\n  and robot.position.x > 1  # ltlc: ignore LTL520",
    ],
)
def test_a_comment_at_the_finding_or_before_it_or_for_the_file_suppresses(text: str) -> None:
    assert "exact-equality" not in found(text)


@pytest.mark.parametrize(
    "text",
    [
        f"{EXACT}\nnever robot.velocity > 1  # ltlc: ignore LTL520",
        f"{EXACT}  # ltlc: ignore LTL504",
        f'decl s /s String.data\neventually s == "# ltlc: ignore-file LTL520"\n{EXACT}',
        f"{EXACT}  # ignore LTL520",
    ],
)
def test_another_place_or_code_suppresses_nothing(text: str) -> None:
    assert "exact-equality" in found(text)


def test_a_comment_that_suppresses_nothing_is_noted() -> None:
    assert found("never robot.velocity > 1  # ltlc: ignore LTL520") == ["idle-suppression"]


def test_a_remark_may_follow_the_codes() -> None:
    assert found(f"{EXACT}  # ltlc: ignore LTL520 since the field counts") == []


def test_a_code_that_does_not_exist_is_noted() -> None:
    assert found("never robot.velocity > 1  # ltlc: ignore LTL999") == ["idle-suppression"]


def test_an_error_of_an_analysis_can_be_suppressed() -> None:
    text = "always (robot.velocity > 2 and robot.velocity < 1)  # ltlc: ignore unsatisfiable"
    assert found(text) == []


UNUSED = "decl pose /pose PoseStamped.pose.position.x"


@pytest.mark.parametrize(
    "text",
    [
        f"# ltlc: ignore-file LTL104\n{UNUSED}\nnever robot.velocity >",
        f"{UNUSED}  # ltlc: ignore LTL104\nnever robot.velocity > 1 and true.x",
        f"# ltlc: ignore unused\n{UNUSED}\nnever (",
        f"# ltlc: ignore-file unused LTL520\n{UNUSED}\neventually robot.velocity == 0\nnever robot.velocty > 1",
    ],
)
def test_a_comment_suppresses_while_the_file_has_an_error_and_is_not_said_to_be_idle(
    text: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, rows = tmp_path / "props.txt", tmp_path / "run.csv"
    path.write_text(text)
    rows.write_text("time,robot.velocity\n0,1\n")
    for command in (
        ["check"],
        ["run", str(rows)],
        ["explain"],
        ["certify", str(rows)],
        ["compare"],
        ["mine", str(rows)],
    ):
        name, *rest = command
        main([name, str(path), *rest])
        told = capsys.readouterr().err
        assert "error[LTL" in told, command
        assert "LTL104" not in told, command
        assert "LTL691" not in told, command
    with pytest.raises(ltlc.UnusableInput) as refused:
        ltlc.monitor(path)
    assert {each.severity for each in refused.value.diagnostics} == {Severity.ERROR}


def test_an_error_of_form_is_not_suppressed() -> None:
    examined = examine(Source("props.txt", "# ltlc: ignore-file LTL101 LTL001\nnever x > 1"), [], EPISODE, Budget())
    assert [each.code for each in examined.diagnostics] == ["LTL101"]
