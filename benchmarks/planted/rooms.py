"""Which tests belong to which room of ltlc: what is changed in a room should be noticed by these at least."""

from __future__ import annotations

from pathlib import Path

PROJECT = Path(__file__).parents[2]
LOOSE = "loose modules"
"""The room of the modules that are in no folder."""

ROOMS = {
    LOOSE: "test_commands_*.py test_fixes.py test_language_check.py test_pytest_plugin.py test_render.py test_api.py"
    " test_dataclass.py",
    "base": "test_commands_*.py test_fixes.py test_language_check.py test_pytest_plugin.py test_render.py test_api.py "
    "test_libraries.py test_release.py test_provenance.py",
    "analysis": "test_analysis_*.py",
    "interfaces/api": "test_api*.py test_commands_compare.py test_comparison_corpus.py test_comparison_pictures.py",
    "assurance": "test_assurance_*.py test_certify_evidence.py test_semantics_certificate.py test_each_code.py "
    "test_each_message_code.py",
    "automata": "test_automata_*.py test_diagrams.py test_progression.py test_violations.py",
    "backends": "test_backends_tools.py test_backends_time.py test_automata_package.py test_comparison_pictures.py",
    "backends/ament": "test_backends_ament.py",
    "backends/c": "test_backends_c*.py test_backends_time.py test_assurance_reading_c.py test_each_c.py"
    " test_each_message_c.py",
    "backends/python": "test_backends_python.py test_backends_time.py test_assurance_replay.py test_ground_truth.py",
    "backends/rust": "test_backends_rust.py test_assurance_reading_rust.py test_each_rust.py",
    "backends/ros2": "test_backends_ros2*.py test_e2e_*.py test_each_code.py test_each_message_code.py",
    "interfaces/building": "test_commands_build.py test_assurance_reading_c.py test_backends_ament.py test_api.py "
    "test_covering_runs.py",
    "monitoring/campaigns": "test_campaigns*.py",
    "base/codes": "test_codes.py test_language_check.py test_render.py",
    "monitoring/columns": "test_columns*.py",
    "interfaces/commands": "test_commands_*.py test_recordings.py test_mining.py test_attesting.py",
    "analysis/comparison": "test_comparison_*.py test_commands_compare.py",
    "interfaces/editor": "test_editor.py test_editor_server.py test_editors.py",
    "monitoring": "test_violations.py test_columns.py test_assurance_evidence*.py",
    "monitoring/judging": "test_recordings*.py test_one_drive_in_all_forms.py test_explained.py test_violations.py "
    "test_robustness.py "
    "test_assurance_evidence.py",
    "frontend/language": "test_language_*.py test_ground_truth.py test_analysis_suppression.py",
    "frontend/layout": "test_layout.py test_commands_format.py",
    "falsification": "test_falsify.py test_commands_falsify.py test_examples_falsify.py",
    "importing": "test_importing*.py test_commands_import.py",
    "base/limits": "test_limits.py",
    "inputs/messages": "test_messages_definitions.py test_language_signals.py",
    "monitoring/matrix": "test_matrix.py",
    "monitoring/measuring": "test_commands_new.py",
    "monitoring/mining": "test_mining.py",
    "interfaces/pages": "test_attesting.py test_pages_*.py test_campaigns_page.py test_api_display.py",
    "program": "test_program_*.py",
    "inputs/recordings": "test_recordings*.py test_bag*.py test_tables*.py test_one_drive_*.py test_damage.py "
    "test_ulog.py",
    "base/render": "test_render*.py",
    "rules": "test_rules.py",
    "monitoring/guarding": "test_guarded_*.py test_api_guard.py test_examples_guard.py",
    "runtime": "test_runtime_*.py test_guarded_*.py test_recordings*.py test_openings.py test_each*.py "
    "test_explained.py",
    "semantics": "test_semantics_*.py test_diagrams.py test_runtime_episodes.py test_openings.py",
    "interfaces/serve": "test_serve.py test_serve_browser.py",
    "specification": "test_specification_*.py test_columns_robustness.py "
    "test_requirements.py test_language_signals.py test_language_margins.py "
    "test_language_guards.py "
    "test_assurance_gate.py",
    "frontend/starter": "test_commands_new.py",
    "frontend/syntax": "test_syntax_parse.py test_language_files.py test_language_check.py test_language_readings.py",
}
"""The tests of each room: patterns of the names of files in `tests/`."""

PLANTED = (".py", ".jinja", ".js", ".html")
"""What faults are planted in: code, and the text that becomes emitted code and pages."""


def files() -> dict[str, list[Path]]:
    """The files of each room, from the tree: a file belongs to the innermost folder that is a room.

    In a single line, which says what a folder is, nothing can be planted.
    """
    found: dict[str, list[Path]] = {}
    for path in sorted((PROJECT / "ltlc").rglob("*")):
        if path.suffix in PLANTED and path.is_file() and len(path.read_bytes().splitlines()) > 1:
            found.setdefault(room_of(path.relative_to(PROJECT / "ltlc")), []).append(path.relative_to(PROJECT))
    return found


def room_of(path: Path) -> str:
    """The room of a file, whose path is given from `ltlc/` on; one that nobody has named is its outermost folder."""
    folders = [str(folder) for folder in path.parents][:-1]
    return next((folder for folder in folders if folder in ROOMS), folders[-1] if folders else LOOSE)


def named_for(room: str) -> list[str]:
    """The files of tests that belong to a room, from the project's folder on."""
    return sorted({f"tests/{t.name}" for pattern in ROOMS[room].split() for t in (PROJECT / "tests").glob(pattern)})
