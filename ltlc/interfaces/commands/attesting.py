"""What `ltlc certify --evidence` writes for others: a statement, a page that prints, and signatures of both."""

from __future__ import annotations

import argparse
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from ltlc.assurance.afresh.files import UnusableError
from ltlc.assurance.evidence.document import printed
from ltlc.assurance.evidence.statement import Result, State, evidence_file, statements
from ltlc.base.files import write_all
from ltlc.interfaces.commands.common import OK, overwritten, unwritable
from ltlc.specification.specification import Specification

NAMESPACE = "ltlc-evidence"
"""What a signature is for: one that was made for something else does not verify."""


def add_outputs(parser: argparse.ArgumentParser) -> None:
    """What may be written about evidence."""
    parser.add_argument(
        "--statement",
        metavar="FILE.jsonl",
        type=Path,
        help="with --evidence, write an in-toto statement for each recording, if all checks accept all claims",
    )
    parser.add_argument(
        "--page",
        metavar="FILE.html",
        type=Path,
        help="with --evidence, write a page that prints: requirements, verdicts, what was checked by what",
    )
    parser.add_argument(
        "--sign",
        metavar="FILE.key",
        type=Path,
        help="sign what --statement and --page write with this SSH key, by `ssh-keygen -Y sign`",
    )


def refuse_unusable(options: argparse.Namespace) -> None:
    """Raise UnusableError if an option has no effect, or a file must not be written."""
    if options.sign and not (options.statement or options.page):
        raise UnusableError("--sign needs --statement or --page, whose files it signs")
    found = [path for path in (options.statement, options.page) if path]
    if found and not options.evidence:
        raise UnusableError("--statement and --page are about --evidence")
    inputs = [options.specification, *options.evidence] if found else []
    if twice := overwritten(
        [*found, *map(_signature, found)], [*inputs, *filter(None, (options.certificate, options.sign))]
    ):
        raise UnusableError(f"{twice} is not written: that file is an input, or another output; give another name")


def attest(options: argparse.Namespace, results: Sequence[Result], state: State, specification: Specification) -> int:
    """Write what was asked for about evidence, whose `state` the checks have found; the exit code of that alone.

    Nothing is stated or signed of what is not accepted, and no signature stays beside what it is not of. Raises
    UnusableError, and writes nothing, if something cannot be signed.
    """
    text = "".join(printed(document) for document, _ in results)  # as it was read
    file, written = evidence_file(options.evidence[0], text.encode()), dict[Path, bytes | str]()
    if options.page:
        from ltlc.analysis.english import English
        from ltlc.interfaces.pages.evidence import page

        properties = specification.properties
        texts = {each.label: each.requirement.text for each in properties if each.requirement}
        english = {each.label: English(each).sentence() for each in properties}
        written[options.page] = page(file, results, state, texts, english)
    if options.statement and state is State.ACCEPTED:
        written[options.statement] = statements(file, results)
    if options.sign and state is State.ACCEPTED:
        written |= {_signature(path): _signed(options.sign, content) for path, content in written.items()}
    try:
        for path in {*map(_signature, written)} - written.keys():
            path.unlink(missing_ok=True)
        write_all(written)
    except OSError as error:
        return unwritable(error.filename, error)
    if state is not State.ACCEPTED and (options.statement or options.sign):
        print("ltlc: nothing is stated or signed, as not all checks accept all claims", file=sys.stderr)
    return OK


def _signed(key: Path, content: bytes | str) -> bytes:
    """The signature of what is written. Raises UnusableError."""
    command = ["ssh-keygen", "-Y", "sign", "-n", NAMESPACE, "-f", str(key)]
    text = content.encode() if isinstance(content, str) else content
    try:
        done = subprocess.run(command, input=text, capture_output=True, check=False)
    except OSError:
        raise UnusableError("ssh-keygen is not installed, which signs (Debian: openssh-client)") from None
    if done.returncode:
        why = done.stderr.decode(errors="replace").strip().rpartition("\n")[2] or "ssh-keygen failed"
        raise UnusableError(f"nothing is written, as it cannot be signed: {why}")
    return done.stdout


def _signature(path: Path) -> Path:
    """Where ssh-keygen writes the signature of a file."""
    return path.with_name(f"{path.name}.sig")
